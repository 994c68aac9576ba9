"""Truths for tests/box_room.rs: the part of two bounces on the cube's top, for wide lights.

    pip install numpy mpmath
    python3 two_bounces.py            # the constants of WIDE
    python3 two_bounces.py check      # one of them by mpmath's tanh-sinh rule instead, in a minute

Albedos and radiance are 1. What a wall sees of the light is Howell's B-4, an element at right angles to a rectangle, and
the walls above z = 1 are seen from (x, y, 1) unhindered. Gauss's rule of 24 nodes on cells that halve towards the
ceiling and towards the walls' ends, in extended precision; lengths are measured from the edges, so nothing cancels.
"""

import sys

import numpy as np

T = np.longdouble
PI = T("3.14159265358979323846264338327950288")


def rule(n=24):
    x = np.polynomial.legendre.leggauss(n)[0].astype(T)
    for _ in range(3):
        before, p = np.ones_like(x), x.copy()
        for k in range(2, n + 1):
            before, p = p, ((2 * k - 1) * x * p - (k - 1) * before) / k
        slope = n * (x * p - before) / (x * x - 1)
        x = x - p / slope
    return (x + 1) / 2, 1 / ((1 - x * x) * slope**2)


NODES, WEIGHTS = rule()


def halving(length, levels=56):
    ends = [T(0)] + [T(length) / T(2) ** i for i in range(levels, -1, -1)]
    points = np.concatenate([a + (b - a) * NODES for a, b in zip(ends, ends[1:])])
    weights = np.concatenate([(b - a) * WEIGHTS for a, b in zip(ends, ends[1:])])
    return points, weights


def seen(c, b, d, far):
    """The light from a wall, c below the ceiling: b to its two ends along the wall, d and far to its edges across."""
    total = 0
    for s, sign in ((np.hypot(d, c), 1), (np.hypot(far, c), -1)):
        for end in b:
            total = total + sign * c / s * np.arctan(end / s)
    return total / (2 * PI)


def two_bounces(h, x, y):
    d, far = T(2) - T(h), T(2) + T(h)
    c, wc = (v[:, None] for v in halving(3))
    e, we = (v[None, :] for v in halving(2))
    total = T(0)
    for own, across in ((x, y), (-x, y), (y, x), (-y, x)):
        for side in (1, -1):
            # half of a wall, measured from its end
            irradiance = seen(c, (e - d, far - e), d, far)
            up, away, along = 3 - c, T(2) - T(own), (2 - e) - side * T(across)
            r2 = up * up + away * away + along * along
            total += np.sum(wc * we * irradiance * up * away / (r2 * r2))
    return total / PI


CASES = [
    (h, x, y)
    for h in (0.5, 1.0, 1.2, 1.5, 1.9, 1.99, 1.999, 1.999999, 2.0)
    for x, y in ((0.0, 0.0), (0.5, -0.5), (0.21, -0.43))
]


def check(h, x, y):
    from mpmath import atan, hypot, mp, mpf, pi, quad

    mp.dps = 20
    d, far = 2 - mpf(h), 2 + mpf(h)
    total = mpf(0)
    for own, across in ((x, y), (-x, y), (y, x), (-y, x)):
        for side in (1, -1):

            def f(c, e):
                near, wide = hypot(d, c), hypot(far, c)
                ends = (e - d, far - e)
                irradiance = sum(c / near * atan(b / near) - c / wide * atan(b / wide) for b in ends)
                up, away, along = 3 - c, 2 - mpf(own), (2 - e) - side * mpf(across)
                return irradiance * up * away / (up * up + away * away + along * along) ** 2

            cuts = [mpf(0)] + ([d] if d > 0 else [])
            total += quad(f, cuts + [mpf(3)], cuts + [mpf(2)], maxdegree=6)
    return total / (2 * pi * pi)


if __name__ == "__main__":
    if len(sys.argv) > 1:
        case = (1.99, 0.21, -0.43)
        print(check(*case), two_bounces(*case))
    else:
        for h, x, y in CASES:
            print(f"    ({h}, [{x}, {y}], {np.format_float_positional(two_bounces(h, x, y), precision=18)}),")
