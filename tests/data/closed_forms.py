"""Truths for tests/vectors.rs: every public closed form of the crate at inputs of every size, by mpmath.

    pip install mpmath
    python3 closed_forms.py > closed_forms.csv          # the committed table: 24 rows a function, seed 1
    python3 closed_forms.py 2000 7 > /tmp/more.csv      # any number of rows, from another seed
    UNBIASED_VECTORS=/tmp/more.csv cargo test --release --test vectors -- --nocapture

Inputs are written as the bits of their f64, truths with 20 digits and as the nearest f64. Each formula below is the
definition, evaluated with 2400 bits (a sum where the crate has a quotient, where that is possible).
"""

import csv
import math
import random
import struct
import sys

from mpmath import mp, mpf

mp.prec = 2400
ROWS = int(sys.argv[1]) if len(sys.argv) > 1 else 24
SEED = int(sys.argv[2]) if len(sys.argv) > 2 else 1
random.seed(SEED)


def bits(x):
    return "0x%016x" % struct.unpack("<Q", struct.pack("<d", x))[0]


def of_bits(b):
    return struct.unpack("<d", struct.pack("<Q", b))[0]


# ---- inputs ----


def between(low, high):
    return random.uniform(low, high)


def size(low, high):
    """A positive number of any size from 10^low to 10^high."""
    return min(max(10.0 ** random.uniform(low, high), 5e-324), 1.7976931348623157e308)


def fraction():
    """In (0, 1): anywhere, tiny, subnormal, near 1, near 1/2, a power of two and its neighbours."""
    kind = random.randrange(8)
    if kind <= 1:
        x = random.random()
    elif kind == 2:
        x = size(-307, 0)
    elif kind == 3:
        x = of_bits(random.randrange(1, 1 << random.randrange(1, 53)))
    elif kind == 4:
        x = 1.0 - 2.0 ** -random.uniform(1, 53)
    elif kind == 5:
        x = 0.5 + random.choice((-1, 1)) * 2.0 ** -random.uniform(2, 53)
    elif kind == 6:
        x = 2.0 ** -random.randrange(1, 1074)
    else:
        b = struct.unpack("<Q", struct.pack("<d", 2.0 ** -random.randrange(0, 60)))[0]
        x = of_bits(b + random.choice((-3, -2, -1)))
    return x if 0.0 < x < 1.0 else 0.5


def usual():
    """In (0, 1), and neither tiny nor within 1e-12 of 1."""
    return random.choice((random.random(), size(-9, 0), 1.0 - size(-12, 0))) or 0.5


def count(most=10**18):
    return random.choice((random.randrange(12), int(10 ** random.uniform(0, len(str(most)) - 1)), random.randrange(most + 1)))


def grid():
    """A number that a generator can give: k·2⁻⁵³."""
    return int(fraction() * 2**53) / 2**53


# ---- truths ----


def exp(x):
    return mp.exp(x) if x > -(10**30) else mpf(0)


def power(p, n):
    return mp.mpf(1) if n == 0 else (exp(n * mp.log(p)) if p > 0 else mpf(0))


# ---- polygons ----

# numbers of their own: the other rows stay what they are
shapes = random.Random(SEED)


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def unit_vector():
    v = [shapes.gauss(0, 1) for _ in range(3)]
    length = dot(v, v) ** 0.5
    return [x / length for x in v]


def sideways(axis):
    """Two unit vectors at right angles to a third, and to each other."""
    u = cross(axis, unit_vector())
    length = dot(u, u) ** 0.5
    u = [x / length for x in u]
    return u, cross(axis, u)


def around(axis, centre, s):
    """A triangle of size s at right angles to an axis."""
    (u, w), turn = sideways(axis), shapes.uniform(0, 2 * math.pi)
    angles = [turn + i * 2 * math.pi / 3 + shapes.uniform(-0.5, 0.5) for i in range(3)]
    return [[centre[i] + s * (math.cos(a) * u[i] + math.sin(a) * w[i]) for i in range(3)] for a in angles]


def any_polygon():
    """Corners and a point 1 or so away from the plane, or from an edge, however large the polygon."""
    s, kind = 10.0 ** shapes.uniform(*shapes.choice(((-16, 0), (0, 16), (0, 300)))), shapes.randrange(5)
    point = [shapes.uniform(-1, 1) for _ in range(3)]
    if kind == 0:  # a rectangle in a plane of two axes
        x, y = [sorted(s * shapes.choice((-1, 1, shapes.uniform(-2, 2))) for _ in range(2)) for _ in range(2)]
        k = shapes.randrange(3)
        flat = [[x[0], y[0], 1.0], [x[1], y[0], 1.0], [x[1], y[1], 1.0], [x[0], y[1], 1.0]]
        corners = [c[k:] + c[:k] for c in flat]
    elif kind == 1:  # a triangle in the plane x = y
        corners = [[a, a, s * shapes.uniform(-1, 1)] for a in (s * shapes.uniform(-1, 1) for _ in range(3))]
    elif kind == 2:  # in any plane, as far as the coordinates allow
        axis = unit_vector()
        corners = around(axis, axis, s)
    elif kind == 3:  # an edge that passes the point
        along, aside, far, t = unit_vector(), unit_vector(), unit_vector(), shapes.random()
        corners = [[-s * t * along[i] + aside[i] for i in range(3)], [s * (1 - t) * along[i] + aside[i] for i in range(3)]]
        corners.append([s * x for x in far])
        point = [0.0] * 3
    else:  # one corner near, the others far
        corners = [unit_vector(), [s * x for x in unit_vector()], [s * x for x in unit_vector()]]
    return corners, point, unit_vector()


def compact_polygon():
    """A triangle of any size below 1, not much longer than wide, seen from 1 within 60° of its axis, and of the normal's."""
    away = unit_vector()
    leaning = []
    while len(leaning) < 2:
        v = unit_vector()
        if dot(v, away) > 0.5:
            leaning.append(v)
    axis, normal = leaning
    s = 10.0 ** shapes.choice((shapes.uniform(-150, 0), shapes.uniform(-3, -1)))
    return around(axis, [0.0] * 3, 0.3 * s), [-x for x in away], normal


def part_of_the_sky(corners, point, normal):
    """P = |Σ Θ Γ·n|/2π over the polygon's edges, cut off at the horizon: 0 in its plane."""
    n = [mpf(x) for x in normal]
    v = [[mpf(a) - mpf(b) for a, b in zip(corner, point)] for corner in corners]
    if dot(v[0], cross(v[1], v[2])) == 0:
        return mpf(0)
    h = [dot(n, x) for x in v]
    above = []
    for i in range(len(v)):
        j = (i + 1) % len(v)
        if h[i] >= 0:
            above.append(v[i])
        if h[i] * h[j] < 0:
            above.append([(a * h[j] - b * h[i]) / (h[j] - h[i]) for a, b in zip(v[i], v[j])])
    total = mpf(0)
    for a, b in zip(above, above[1:] + above[:1]):
        gamma = cross(a, b)
        sin = mp.sqrt(dot(gamma, gamma))
        if sin != 0:
            total += mp.atan2(sin, dot(a, b)) * dot(n, gamma) / sin
    return abs(total) / mp.sqrt(dot(n, n)) / (2 * mp.pi)


def polygon(name, shape):
    corners, point, normal = shape
    if shapes.random() < 0.5:
        corners = corners[::-1]
    first = shapes.randrange(len(corners))
    vectors = dict(p=point, n=normal) | {"c%d" % i: c for i, c in enumerate(corners[first:] + corners[:first])}
    given = {name + axis: x for name, v in vectors.items() for axis, x in zip("xyz", v)}
    return name, given, part_of_the_sky(corners, point, normal)


def rows():
    pi = mp.pi
    for _ in range(ROWS):
        # exponential
        rate, u = random.choice((size(-323, 308), size(-3, 3), 1.0, 0.5)), fraction()
        x = random.choice((size(-323, 308), -float(mp.log1p(-mpf(u)) / mpf(rate)), random.choice((1, 37.5, 700, 740)) / rate))
        x = x if x < 1e308 else 1.0
        r, mu, mx = mpf(rate), mpf(u), mpf(x)
        yield "exp_inv_1mu", dict(u=u, lam=rate), -mp.log1p(-mu) / r
        yield "exp_sf", dict(x=x, lam=rate), exp(-r * mx)
        yield "exp_pdf", dict(x=x, lam=rate), r * exp(-r * mx)
        yield "exp_cdf", dict(x=x, lam=rate), 1 - exp(-r * mx) if r * mx > mpf(2) ** -1100 else r * mx
        yield "exp_mean", dict(lam=rate), 1 / r
        yield "exp_var", dict(lam=rate), 1 / r**2

        # bounces
        p, n = fraction(), count()
        if random.random() < 0.5 and p > 0.5:
            n = int(min(1e18, random.uniform(0, 50) / (1 - p)))
        mp_ = mpf(p)
        yield "geom_pmf", dict(n=n, p=p), power(mp_, n) * (1 - mp_)
        yield "geom_sf", dict(n=n, p=p), power(mp_, n + 1)
        yield "geom_cdf", dict(n=n, p=p), 1 - power(mp_, n + 1)
        yield "geom_mean", dict(p=p), mp_ / (1 - mp_)
        yield "geom_var", dict(p=p), mp_ / (1 - mp_) ** 2
        yield "rr_weight", dict(p=p), 1 / mp_

        # light paths
        rho, v = random.choice(((fraction(), fraction()), (usual(), usual())))
        R, V = mpf(rho), mpf(v)
        q = random.choice((fraction(), rho + (1 - rho) * random.random(), rho * rho * (1 + size(-9, 0))))
        q = q if 0 < q < 1 else 0.5
        Q = mpf(q)
        A, B = (V * R / (1 - R)) ** 2, V * (1 - V)
        paths = (A * (1 - Q) + B * Q) / (Q - R**2) if Q > R**2 else mp.inf
        vertices = random.choice((1.0, size(0, 9), size(-300, 300)))
        C = mpf(vertices)
        yield "light_mean", dict(rho=rho, v=v), V / (1 - R)
        root = (mp.sqrt(A**2 + (B - A) * (A + B * R**2)) - A) / (B - A) if A != B else (A + B * R**2) / (2 * A)
        yield "light_optimum", dict(rho=rho, v=v), root
        yield "paths_var", dict(rho=rho, v=v, q=q), paths
        yield "paths_cost", dict(rho=rho, v=v, q=q), 1 / (1 - Q)
        yield "paths_mse", dict(rho=rho, v=v, q=q, vertices=vertices), paths / (1 - Q) / C
        last = random.choice((random.randrange(20), random.randrange(1000), int(10 ** random.uniform(0, 9))))
        left = power(R, last + 1)
        kept = V * (1 - left) / (1 - R)
        truncated = B * (1 - left**2) / (1 - R**2)
        yield "furnace_S_k", dict(k=last, rho=rho), (1 - left) / (1 - R)
        yield "truncated_mean", dict(rho=rho, v=v, k=last), kept
        yield "truncated_bias", dict(rho=rho, v=v, k=last), -V * left / (1 - R)
        yield "truncated_var", dict(rho=rho, v=v, k=last), truncated
        mse = (V * left / (1 - R)) ** 2 + truncated * (last + 1) / C
        yield "truncated_mse", dict(rho=rho, v=v, k=last, vertices=vertices), mse
        if q > rho * rho:
            lead = paths / (1 - Q) - truncated * (last + 1)
            crossing = max(mpf(0), lead / (V * left / (1 - R)) ** 2) if left else mpf(0)
            # the condition number of the difference: how many ulp one ulp in a term costs
            worst = paths / (1 - Q) / abs(lead) if lead else mp.inf
            if worst < 1.5 and rho < 1 - 1e-9:
                yield "light_crossing", dict(rho=rho, v=v, q=q, k=last), crossing

        # directions: a turn v of any kind, on the grid
        u, turn = fraction(), grid()
        U = mpf(u)
        for name, cos, sin in (("uniform", 1 - U, mp.sqrt(U * (2 - U))), ("cosine", mp.sqrt(1 - U), mp.sqrt(U))):
            at = dict(u=u, v=turn)
            yield name + "_cos", at, cos
            yield name + "_sin", at, sin
            yield name + "_theta", at, mp.atan2(sin, cos)
            yield name + "_phi", at, 2 * pi * mpf(turn)
            yield name + "_pdf", at, 1 / (2 * pi) if name == "uniform" else cos / pi
        yield "coshemi_weight", dict(u=grid()), mpf(0.5)
        largest = size(-300, 300)
        x, y, z = (random.choice((-1, 1)) * largest * random.choice((1.0, random.random(), size(-18, 0))) for _ in range(3))
        X, Y, Z = mpf(x), mpf(y), mpf(z)
        at = dict(x=x, y=y, z=z)
        yield "direction_theta", at, mp.atan2(mp.hypot(X, Y), Z)
        phi = mp.atan2(Y, X)
        yield "direction_phi", at, phi if phi >= 0 else phi + 2 * pi
        yield "direction_cos", at, Z / mp.sqrt(X * X + Y * Y + Z * Z)

        # diffuse surfaces
        albedo, light = random.choice((fraction(), random.random())), size(-300, 300)
        a = random.choice((between(-2, 20), -2 + size(-15, 0), -1 + random.choice((-1, 1)) * size(-15, 0), -1.5 + size(-15, 0)))
        a = random.choice((a, a, size(-300, 300), -size(-300, -1)))
        a = a if a > -2 else -0.5
        W = mpf(albedo)
        M = mpf(a)
        yield "brdf", dict(albedo=albedo), W / pi
        yield "reflected", dict(albedo=albedo, light=light), W * mpf(light)
        at = dict(albedo=albedo, a=a)
        yield "power_reflected", at, 2 * W / (M + 2)
        yield "power_uniform", at, 4 * W**2 * (M + 1) ** 2 / ((2 * M + 3) * (M + 2) ** 2) if a > -1.5 else mpf(0) if a == -1 else mp.inf
        yield "power_cosine", at, W**2 * M**2 / ((M + 1) * (M + 2) ** 2) if a > -1 else mpf(0) if a == 0 else mp.inf
        ring = fraction()
        E = mpf(ring)
        at = dict(albedo=albedo, ring=ring)
        yield "ring_reflected", at, W * E**2
        yield "ring_uniform", at, W**2 * (4 * E**3 / 3 - E**4)
        yield "ring_cosine", at, W**2 * E**2 * (1 - E**2)

        # rectangles: the ends far apart, close together, of one sign or both
        def ends():
            kind = random.randrange(4)
            if kind == 0:
                low, high = between(-9, 9), between(-9, 9)
            elif kind == 1:
                low, high = 0.0, size(-150, 150)
            elif kind == 2:
                low = between(1, 1000)
                high = low * (1 + size(-12, 0))
            else:
                low, high = -size(-90, 90), size(-90, 90)
            return sorted((low, high if low != high else low + 1.0))

        (xa, xb), (ya, yb) = ends(), ends()
        area = (mpf(xb) - mpf(xa)) * (mpf(yb) - mpf(ya))
        at = dict(a=xa, b=xb, c=ya, d=yb)
        yield "rectangle_area", at, area
        yield "rectangle_density", at, 1 / area
        u = grid()
        for _ in range(3):
            yield polygon("polygon", any_polygon())
            yield polygon("polygon_compact", compact_polygon())
        # a large rate brings e^(−λx) back from below f64
        rate = size(280, 308)
        x = between(500, 1440) / rate
        yield "exp_pdf", dict(x=x, lam=rate), mpf(rate) * exp(-mpf(rate) * mpf(x))
        yield "box_lerp", dict(u=u, lo=xa, hi=xb), mpf(xa) + mpf(u) * (mpf(xb) - mpf(xa))


def digits(x):
    """20 digits, as in extremes.csv."""
    if x == 0:
        return "0"
    return mp.nstr(x, 20, min_fixed=0, max_fixed=0, strip_zeros=False) if mp.isfinite(x) else "inf"


def nearest(x):
    """The nearest f64, ties to even, subnormals and infinities too: what float(str) does."""
    return float(mp.nstr(x, 60, min_fixed=0, max_fixed=0)) if mp.isfinite(x) else float("inf")


def main():
    out = csv.writer(sys.stdout, lineterminator="\n")
    out.writerow(["id", "fn", "inputs", "input_bits", "true20", "f64"])
    table = sorted(rows(), key=lambda row: row[0])
    for i, (name, given, truth) in enumerate(table):
        text = ";".join("%s=%r" % item for item in given.items())
        raw = ";".join("%s=%s" % (k, v if isinstance(v, int) else bits(v)) for k, v in given.items())
        out.writerow([i + 1, name, text, raw, digits(truth), repr(nearest(truth))])


main()
