"""The estimators in numpy on one thread, in ns per draw: one JSON object per row.

usage: python3 numpy_draws.py [DRAWS]     Install: pip install numpy
Each row is the best of several runs; its mean shows that the result is right.
"""
import json
import sys
import time

import numpy as np

draws = int(sys.argv[1]) if len(sys.argv) > 1 else 65_536
rng = np.random.default_rng(1)


def square():
    x, y = rng.uniform(-2, 2, draws), rng.uniform(-2, 2, draws)
    return 16 * np.exp(-x * x - y * y)


def cosine():
    r, phi = np.sqrt(rng.random(draws)), 2 * np.pi * rng.random(draws)
    return 0.8 * (1 + r * np.cos(phi))


def uniform():
    z, phi = rng.random(draws), 2 * np.pi * rng.random(draws)
    return 2 * 0.8 * (1 + np.sqrt(1 - z * z) * np.cos(phi)) * z


rows = {
    "uniform": lambda: rng.random(draws),
    "exponential, log1p": lambda: -np.log1p(-rng.random(draws)),
    "exponential, log": lambda: -np.log(1 - rng.random(draws)),
    "exponential, library": lambda: rng.exponential(size=draws),
    "square": square,
    "cosine": cosine,
    "uniform directions": uniform,
    "bounces": lambda: rng.geometric(0.2, draws) - 1,
}
for name, row in rows.items():
    best, mean = float("inf"), 0.0
    for _ in range(15):
        start = time.perf_counter()
        mean = float(row().mean())
        best = min(best, time.perf_counter() - start)
    print(json.dumps({"row": name, "ns": best / draws * 1e9, "mean": mean}), flush=True)
