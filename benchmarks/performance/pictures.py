"""Cases of pictures: tables of measured values beside Ward's model, in one scene."""

import os
import time
from pathlib import Path

import numpy as np

import brdfkit as bk

ROUNDS = 5  # of which the fastest picture counts
SIZE, SPP, TABLES_SPP = 256, 64, 16
# Measured materials that are shipped, and files below BRDFKIT_DATA
SHIPPED = (
    "red_plastic", "car_paint", "dusty_gold", "blasted_gold", "plaster", "satin_plastic",
    "brushed_aluminium", "gold_brocade",
)  # fmt: skip
FILES = {
    "retro-3M-jaune": "alta_retro/retro-3M-jaune.dat.xz",
    "acryl_blue": "cornell/acryl_blue.brdf",
    "cc_iris_purple_gem_rgb": "rgl/cc_iris_purple_gem_rgb.bsdf",
}


def prepare_tables():
    """Return a function that tells the least seconds of a picture of each material."""
    from brdfkit.core.jit import llvm

    llvm.use_variant()
    folder = Path(os.environ.get("BRDFKIT_DATA", ""))
    materials = {name: bk.load(name).scene_dict() for name in SHIPPED}
    for name, file in FILES.items():
        if "BRDFKIT_DATA" in os.environ and (folder / file).exists():
            materials[name] = bk.load(folder / file).scene_dict()
    materials = {"ward": bk.models()["ward"]().scene_dict()} | materials
    return lambda: {"by_name": time_pictures(materials, TABLES_SPP)}


def time_pictures(materials, spp=SPP):
    """Return the least seconds of a warm rendering, by material."""
    import mitsuba as mi

    from brdfkit.rendering.scenes.ball import ball

    scenes = {name: mi.load_dict(ball(m, (SIZE, SIZE), spp)) for name, m in materials.items()}
    best = dict.fromkeys(scenes, np.inf)
    for round_ in range(ROUNDS + 1):
        for name, scene in scenes.items():
            best[name] = min(best[name], time_picture(scene, round_, spp))
    return best


def time_picture(scene, seed, spp=SPP):
    """Return the seconds of a picture."""
    import mitsuba as mi

    began = time.perf_counter()
    np.array(mi.render(scene, spp=spp, seed=seed))
    return time.perf_counter() - began


CASES = {"pictures: tables": prepare_tables}
