"""Figures for release notes: `make bench`. Ratios within one run; seconds are of this machine.

Per model: the spread of its sample weights at five incidences, its greatest albedo to 85°, the
time of a rendering in units of Mitsuba's roughplastic, the seconds that a first rendering takes
longer than the next (all kernels compiled anew where DRJIT_CACHE_DIR is an empty folder), and
those of a warm fit of a full MERL table.
"""

import sys
import time

import numpy as np
from rich.console import Console
from rich.table import Table as Printed

import brdfkit as bk
from brdfkit import llvm
from brdfkit.checks.sampling import spread
from brdfkit.checks.subject import INCIDENCES, Subject, incidences
from brdfkit.table import Table

MERL = (90, 90, 180)
ROUNDS = 5
SIZE, SPP = 256, 64


def full_table():
    """A shipped material at the resolution of a MERL file."""
    table = Table(np.full((*MERL, 3), np.nan))
    wi, wo = table.directions()
    above = (wi[..., 2] > 0) & (wo[..., 2] > 0)
    table.values[above] = bk.load("car_paint").eval(wi[above], wo[above])
    return bk.Measured.from_table(table.values, name="car_paint, full size")


def fit_seconds(name, data, loss):
    """Seconds of a warm fit."""
    bk.fit(name, data, loss)
    return min(bk.fit(name, data, loss).seconds for _ in range(2))


def render_seconds(materials):
    """(least seconds of a warm rendering, seconds that the first took longer) by material."""
    import mitsuba as mi

    from brdfkit.scenes import ball

    scenes, first = {}, {}
    for name, bsdf in materials.items():
        scenes[name] = mi.load_dict(ball(bsdf, (SIZE, SIZE), SPP))
        first[name] = _rendered(scenes[name], 0)
    best = dict.fromkeys(scenes, np.inf)
    for round_ in range(1, ROUNDS + 1):
        for name, scene in scenes.items():
            best[name] = min(best[name], _rendered(scene, round_))
    return {name: (best[name], first[name] - best[name]) for name in scenes}


def _rendered(scene, seed):
    import mitsuba as mi

    began = time.perf_counter()
    np.array(mi.render(scene, spp=SPP, seed=seed))
    return time.perf_counter() - began


def all_in_one_scene(models):
    """Seconds to compile one scene with a ball of every model, and one with the first model."""
    import mitsuba as mi

    def scene(chosen):
        balls = {
            f"ball_{k}": {
                "type": "sphere",
                "center": [3 * k, 0, 0],
                "bsdf": model().scene_dict(),
            }
            for k, model in enumerate(chosen)
        }
        camera = mi.ScalarTransform4f().look_at([20, 60, 0], [20, 0, 0], [0, 0, 1])
        film = {"type": "hdrfilm", "width": 64, "height": 16}
        sensor = {"type": "perspective", "to_world": camera, "film": film}
        return mi.load_dict(
            {
                "type": "scene",
                "integrator": {"type": "path"},
                "sensor": sensor,
                "light": {"type": "constant"},
                **balls,
            }
        )

    seconds = []
    for chosen in (list(models), list(models)[:1]):
        loaded = scene(chosen)
        first = _rendered(loaded, 0)
        seconds.append(first - _rendered(loaded, 1))
    return seconds


def main():
    llvm.use_variant()
    out = Console(width=160)
    every, one = all_in_one_scene(bk.models().values())
    materials = {"roughplastic": {"type": "roughplastic", "alpha": 0.2}}
    materials |= {name: model().scene_dict() for name, model in bk.models().items()}
    materials["measured_table"] = bk.load("car_paint").scene_dict()
    seconds = render_seconds(materials)
    data = full_table()
    columns = [f"std {d}°" for d in INCIDENCES]
    losses = [f"fit {loss} [s]" for loss in bk.losses]
    table = Printed("model", *columns, "albedo", "time", "compile [s]", *losses)
    for name, (best, compiled) in seconds.items():
        row = [f"{best / seconds['roughplastic'][0]:.2f}", f"{compiled:.2f}"]
        if name not in bk.models():
            table.add_row(name, *[""] * len(columns), "", *row)
            continue
        subject = Subject(bk.models()[name]())
        spreads = [f"{spread(subject, degrees):.2f}" for degrees in INCIDENCES]
        brightest = max(bk.albedo(subject.thing, wi).max() for _, wi in incidences())
        fits = [f"{fit_seconds(name, data, loss):.2f}" for loss in bk.losses]
        table.add_row(name, *spreads, f"{brightest:.3f}", *row, *fits)
    out.print(table)
    out.print(f"compiling a scene of {len(bk.models())} models: {every:.2f} s, of one: {one:.2f} s")
    return 0


if __name__ == "__main__":
    sys.exit(main())
