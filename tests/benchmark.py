"""Figures for release notes: `make bench`. Ratios within one run; seconds are of this machine.

Times a fit of a full MERL table per model and loss, warm, and the rendering of a ball per model
in units of Mitsuba's own roughplastic.
"""

import sys
import time

import numpy as np
from rich.console import Console
from rich.table import Table as Printed

import brdfkit as bk
from brdfkit import llvm
from brdfkit.table import Table

MERL = (90, 90, 180)
ROUNDS = 5


def full_table():
    """A shipped material at the resolution of a MERL file."""
    table = Table(np.full((*MERL, 3), np.nan))
    wi, wo = table.directions()
    above = (wi[..., 2] > 0) & (wo[..., 2] > 0)
    table.values[above] = bk.load("car_paint").eval(wi[above], wo[above])
    return bk.Measured.from_table(table.values, name="car_paint, full size")


def fits(data):
    """Seconds of a warm fit, loss → model → seconds."""
    seconds = {loss: {} for loss in bk.losses}
    for name in bk.models():
        for loss in bk.losses:
            bk.fit(name, data, loss)
            seconds[loss][name] = min(bk.fit(name, data, loss).seconds for _ in range(2))
    return seconds


def throughput(size=256, spp=64):
    """Least time of a warm rendering, in units of roughplastic's, by material."""
    import mitsuba as mi

    from brdfkit.scenes import ball

    materials = {"roughplastic": {"type": "roughplastic", "alpha": 0.2}}
    materials |= {name: model().scene_dict() for name, model in bk.models().items()}
    materials["measured_table"] = bk.load("car_paint").scene_dict()
    scenes = {n: mi.load_dict(ball(bsdf, (size, size), spp)) for n, bsdf in materials.items()}
    best = dict.fromkeys(scenes, np.inf)
    for round_ in range(ROUNDS + 1):
        for name, scene in scenes.items():
            began = time.perf_counter()
            np.array(mi.render(scene, spp=spp, seed=round_))
            if round_:  # the first compiles
                best[name] = min(best[name], time.perf_counter() - began)
    return {name: t / best["roughplastic"] for name, t in best.items()}


def main():
    out = Console(width=100)
    llvm.use_variant()
    ratios = throughput()
    seconds = fits(full_table())
    table = Printed("model", *(f"fit, {loss} [s]" for loss in bk.losses), "time / roughplastic")
    for name, ratio in ratios.items():
        times = [f"{seconds[loss][name]:.2f}" if name in seconds[loss] else "" for loss in seconds]
        table.add_row(name, *times, f"{ratio:.2f}")
    out.print(table)
    return 0


if __name__ == "__main__":
    sys.exit(main())
