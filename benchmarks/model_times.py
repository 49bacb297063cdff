"""Measures sample weights, albedo and times of all models, for release notes: `make bench`.

For each model it prints the spread of its sample weights at five angles of incidence, its largest
albedo up to 85°, and the time of a rendering in units of Mitsuba's roughplastic. Further columns
are the seconds that the first rendering of a tiny scene takes longer than the next, for compilation
if DRJIT_CACHE_DIR is an empty folder, and the seconds of a warm fit of a full MERL table. Ratios
are of one run; seconds are of this machine.
"""

import sys

import numpy as np
from performance.fits import make_full_table
from performance.pictures import time_picture, time_pictures
from rich.console import Console
from rich.table import Table as Printed

import brdfkit as bk
from brdfkit.checks.material_subject import INCIDENCES, Subject, list_incidences
from brdfkit.checks.sampling import compute_weight_spreads
from brdfkit.core.discovery.plugin_pages import read_page
from brdfkit.core.jit import llvm

# The models of [Kurt 2007]; the other models come from later papers
THESIS = [n for n, m in bk.models().items() if n != "mixture" and "[Kurt 2007" in str(read_page(m))]


def time_fit(name, data, loss):
    """Return the seconds of a warm fit, the least of two."""
    bk.fit(data, name, loss=loss)
    return min(bk.fit(data, name, loss=loss).seconds for _ in range(2))


def time_compilation(bsdfs):
    """Return the seconds to compile one scene with a small ball of each of some BSDFs."""
    import mitsuba as mi

    balls = {
        f"ball_{k}": {"type": "sphere", "center": [3 * k, 0, 0], "bsdf": bsdf}
        for k, bsdf in enumerate(bsdfs)
    }
    camera = mi.ScalarTransform4f().look_at([20, 60, 0], [20, 0, 0], [0, 0, 1])
    film = {"type": "hdrfilm", "width": 64, "height": 16}
    scene = {
        "type": "scene",
        "integrator": {"type": "path"},
        "sensor": {"type": "perspective", "to_world": camera, "film": film},
        "light": {"type": "constant"},
    }
    loaded = mi.load_dict(scene | balls)
    first = time_picture(loaded, 0)
    return first - time_picture(loaded, 1)


def main():
    llvm.use_variant()
    out = Console(width=160)
    time_compilation(
        [{"type": "diffuse"}]
    )  # so that work of the first scene in a process is not counted
    materials = {"roughplastic": {"type": "roughplastic", "alpha": 0.2}}
    materials |= {name: model().scene_dict() for name, model in bk.models().items()}
    materials["measured_table"] = bk.load("car_paint").scene_dict()
    compiled = {name: time_compilation([bsdf]) for name, bsdf in materials.items()}
    twelve = time_compilation([bk.models()[name]().scene_dict() for name in THESIS])
    seconds = time_pictures(materials)
    data = make_full_table()
    columns = [f"std {d}°" for d in INCIDENCES]
    losses = [f"fit {loss} [s]" for loss in bk.losses.named.by_sample]
    table = Printed("model", *columns, "albedo", "time", "compile [s]", *losses)
    for name, best in seconds.items():
        row = [f"{best / seconds['roughplastic']:.2f}", f"{compiled[name]:.2f}"]
        if name not in bk.models():
            table.add_row(name, *[""] * len(columns), "", *row)
            continue
        subject = Subject(bk.models()[name]())
        spreads = [f"{spread:.2f}" for spread in compute_weight_spreads(subject)]
        brightest = max(bk.albedo(subject.material, wi).max() for _, wi in list_incidences())
        fits = [f"{time_fit(name, data, loss):.2f}" for loss in bk.losses.named.by_sample]
        table.add_row(name, *spreads, f"{brightest:.3f}", *row, *fits)
    out.print(table)
    one = np.mean([compiled[name] for name in THESIS])
    out.print(f"compiling a scene of the thesis's twelve: {twelve:.2f} s, of one: {one:.2f} s")
    return 0


if __name__ == "__main__":
    sys.exit(main())
