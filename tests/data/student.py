"""Truths for tests/estimate.rs: Student's t for confidence levels, by mpmath.

    pip install mpmath
    python3 student.py > student.csv               # the committed table: 209 degrees of freedom, seed 1
    python3 student.py 100000 7 > /tmp/more.csv    # each 1 % more, and as many random pairs, from seed 7
    UNBIASED_STUDENT=/tmp/more.csv cargo test --release --test estimate students -- --nocapture

P(|T| <= t) is the regularised incomplete beta function I_y(1/2, nu/2), y = t^2/(nu + t^2), and what is left
of it is I_x(nu/2, 1/2), x = nu/(nu + t^2); both are hypergeometric series of positive terms. t is found by
Newton's method, for the level that is the f64 written. Of 60 digits x^(nu/2) costs 20 at most, and 1 - P 16.
"""

import random
import sys

from mpmath import mp, mpf

mp.dps = 60
PAIRS = int(sys.argv[1]) if len(sys.argv) > 1 else 0
random.seed(int(sys.argv[2]) if len(sys.argv) > 2 else 1)

LEVELS = (1e-10, 1e-6, 1e-4, 0.01, 0.5, 0.6827, 0.9, 0.95, 0.99, 0.9999, 1 - 1e-9, 1 - 1e-12)


def series(a, b, x):
    """I_x(a, b) over its derivative by ln(x/(1 - x)): the sum of (a + b)_n/(a + 1)_n x^n/a."""
    term = total = 1 / a
    n = 0
    while term > total * mp.eps:
        term *= (a + b + n) / (a + 1 + n) * x
        total += term
        n += 1
    return total


def quantile(nu, level):
    a, half, level = mpf(nu) / 2, mpf(1) / 2, mpf(level)
    z2 = 2 * mp.erfinv(level) ** 2
    t2 = nu * mp.expm1(z2 / nu)
    scale = 2 / mp.beta(a, half)
    while True:
        x, y = nu / (nu + t2), t2 / (nu + t2)
        density = scale * mp.sqrt(y) * x**a  # of ln |T|
        if y < half:
            inside = density / 2 * series(half, a, y)
            outside = 1 - inside
        else:
            outside = density / 2 * series(a, half, x)
            inside = 1 - outside
        # ln P and ln Q are concave in ln t: no step goes astray
        if level < half:
            step = mp.log(level / inside) * inside / density
        else:
            step = mp.log(outside / (1 - level)) * outside / density
        t2 *= mp.exp(2 * step)
        # the next error is of the order of this step's square
        if abs(step) < 1e-13:
            return mp.sqrt(t2)


def steps(factor, last):
    nu = 1
    while nu <= last:
        yield nu
        nu = max(nu + 1, int(nu * factor))


def pairs():
    if PAIRS == 0:
        scattered = [int(10 ** random.uniform(1, 9)) for _ in range(150)]
        special = [999, 1000, 1001, 109810, 10**7, 10**7 + 1, 10**12, 2**53 + 1, 2**64 - 2]
        chosen = set([*range(1, 31), *steps(1.6, 10**9), *scattered, *special])
        yield from ((nu, level) for nu in sorted(chosen) for level in LEVELS)
        return
    yield from ((nu, level) for nu in steps(1.01, 10**9) for level in LEVELS)
    for _ in range(PAIRS):
        nu = int(10 ** random.uniform(0, random.choice((2, 9, 19))))
        size = 10 ** random.uniform(-12, 0)
        yield nu, random.choice((random.random(), 1 - size, 10 ** random.uniform(-10, 0)))


def main():
    print("nu,level,t")
    for nu, level in pairs():
        # a random level may round to an end
        if 0.0 < level < 1.0:
            print("%d,%r,%s" % (nu, level, mp.nstr(quantile(nu, level), 20, min_fixed=0, max_fixed=0)))


main()
