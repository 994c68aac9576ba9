"""The box room in Mitsuba 3 on all cores: one JSON object per number of bounces, with paths per second and the
variance of a path over the mean's square.

usage: python3 mitsuba_box.py VARIANT SAMPLER RENDERS SPP SEED BOUNCES...      VARIANT: llvm_ad_mono or
scalar_rgb
SAMPLER: independent, stratified, multijitter or orthogonal. (ldsampler's mean is off: 0.3145 for 0.31276 at
two bounces.)
Install: pip install mitsuba numpy; for llvm_ad_mono libLLVM, and DRJIT_LIBLLVM_PATH=<libLLVM.so>.
The first render, which compiles, is not timed; the time is that of the fastest of the others. With
independent samples the variance is that of 400 small renders, known to 7 %; with other samplers,
whose variance depends on the number of samples, it is that of the timed renders. It is given per path. The
film sums in f32: near 1e6 samples per render its mean is off by about 1e-4.
"""
import json
import sys
import time

import mitsuba as mi
import numpy as np

variant, sampler = sys.argv[1:3]
renders, spp, first_seed, *bounces = [int(number) for number in sys.argv[3:]]
SMALL, SMALL_SPP = 400, 2000
mi.set_variant(variant)


def grey(value):
    return value if "mono" in variant else {"type": "rgb", "value": value}


def diffuse(albedo):
    return {"type": "diffuse", "reflectance": grey(albedo)}


def face(centre, normal, side, bsdf, **extra):
    up = [0, 1, 0] if abs(normal[2]) > 0.5 else [0, 0, 1]
    target = [c + n for c, n in zip(centre, normal)]
    place = mi.ScalarTransform4f().look_at(origin=centre, target=target, up=up)
    shape = place @ mi.ScalarTransform4f().scale([side / 2, side / 2, 1])
    return {"type": "rectangle", "to_world": shape, "bsdf": bsdf, **extra}


def scene(most):
    wall, cube = diffuse(0.5), diffuse(0.8)
    faces = {
        "west": face([-2, 0, 2], [1, 0, 0], 4, wall),
        "east": face([2, 0, 2], [-1, 0, 0], 4, wall),
        "south": face([0, -2, 2], [0, 1, 0], 4, wall),
        "north": face([0, 2, 2], [0, -1, 0], 4, wall),
        "floor": face([0, 0, 0], [0, 0, 1], 4, wall),
        "ceiling": face([0, 0, 4], [0, 0, -1], 4, wall),
        "top": face([0, 0, 1], [0, 0, 1], 1, cube),
        "cube_west": face([-0.5, 0, 0.5], [-1, 0, 0], 1, cube),
        "cube_east": face([0.5, 0, 0.5], [1, 0, 0], 1, cube),
        "cube_south": face([0, -0.5, 0.5], [0, -1, 0], 1, cube),
        "cube_north": face([0, 0.5, 0.5], [0, 1, 0], 1, cube),
    }
    light = {"type": "area", "radiance": grey(10.0)}
    film = {"type": "hdrfilm", "width": 1, "height": 1, "rfilter": {"type": "box"}, "pixel_format": "luminance"}
    return mi.load_dict({
        "type": "scene",
        "integrator": {"type": "path", "max_depth": most + 1, "rr_depth": 1000},
        "light": face([0, 0, 3.99999], [0, 0, -1], 1, diffuse(0.0), emitter=light),
        "eye": {
            "type": "radiancemeter",
            "origin": [0.3, 0.2, 1.9],
            "direction": [-0.3, -0.2, -0.9],
            "film": film,
            "sampler": {"type": sampler, "sample_count": spp},
        },
        **faces,
    })


def render(room, spp, seed):
    """The mean of a render, and its seconds."""
    start = time.perf_counter()
    value = float(np.array(mi.render(room, spp=spp, seed=seed)).ravel()[0])
    return value, time.perf_counter() - start


for most in bounces:
    room = scene(most)
    _, *large = [render(room, spp, first_seed + i) for i in range(renders + 1)]
    values, count = [value for value, _ in large], spp
    mean = float(np.mean(values))
    if sampler == "independent":
        values, count = [render(room, SMALL_SPP, first_seed + renders + 1 + i)[0] for i in range(SMALL)], SMALL_SPP
    print(json.dumps({
        "bounces": most,
        "mean": mean,
        "paths_per_second": spp / min(seconds for _, seconds in large),
        "variance": float(np.var(values, ddof=1)) * count / mean**2,
    }), flush=True)
