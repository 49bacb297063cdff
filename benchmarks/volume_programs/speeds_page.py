"""Writes docs/view_programs.md: the speed of `brdfkit view` beside that of other programs."""

import os
import platform
from pathlib import Path

import numpy as np

from .case import NAMES, Case
from .page import compute_errors

PAGE = Path(__file__).parents[2] / "docs/view_programs.md"
ROWS = (
    ("brdfkit", "turning"),
    ("brdfkit", "at rest"),
    ("VTK", "right unit"),
    ("VTK", "careful"),
    ("PyVista", "careful"),
    ("K3D", "512 samples"),
)
SIZES = "256", "512"
SAMPLES = {"turning": 1, "at rest": 64}  # of brdfkit's pictures, per pixel
STEPS = {"turning": 64, "at rest": 128}  # along a ray through 128³ voxels, in brdfkit's view
HEAD = "", "first picture", "256²", "512²", "PSNR", "worst case"
INTRODUCTION = """# The speed of a view, in every program

Made by `python benchmarks/compare_view_programs.py`, in one run{machine}.
All programs show {side}³ voxels of smoke by emission and absorption, by the same transfer function,
on processors alone: VTK and PyVista by Mesa, K3D by WebGL in Chromium with SwiftShader. They are
made for graphics cards, and are faster with one; brdfkit needs none.

"""
NOTES = """
- **First picture**: from the start of the program until a picture of 512² is there, with all that
  it imports; for brdfkit from the command `brdfkit view` until its page shows the picture, for K3D
  until its page has drawn it. Chromium runs before. brdfkit's kernels were compiled by an earlier
  run.
- **256², 512²**: pictures a second while the camera turns, the median of 12, or of as many as take
  15 seconds. brdfkit's are rendered, tone-mapped and encoded; the others' are drawn and read back.
- **In brackets**: CPU time of all cores, for a picture or until the first one. It is the fairer
  figure where other programs run on the same machine. Here {busy}.
- **PSNR** over the cases of emission and absorption of the
  [conformance set](../data/conformance/README.md), and in the worst of them: 10 log₁₀(1 / MSE)
  against exact pictures. [The same volume in every program](volume_programs.md) says where errors
  come from, and what "right unit" and "careful" mean. At the right unit, VTK ends the volume half a
  voxel too early, which is most of its error.
- **Turning**, brdfkit renders one sample per pixel, at a random place in each step of a ray, and
  half as many steps as there are voxels along the volume's edge: the error is noise. **At rest** it
  takes a step for each voxel, and the mean of passes; the PSNR is that of 64.
"""


def write_page(found: dict, side: int) -> None:
    """Write the page; `found` has the times of each of `ROWS`, or its error."""
    rows = [format_row(*row, found[row]) for row in ROWS]
    lines = [HEAD, ["---"] * len(HEAD), *rows]
    table = "".join(f"| {' | '.join(line)} |\n" for line in lines)
    load = os.getloadavg()[2]
    busy = "no other did" if load < 1.5 else f"{load:.0f} wanted to run at a time"
    notes = NOTES.format(busy=busy)
    machine = f" on {platform.machine()} with {count_cores()} cores"
    PAGE.write_text(
        INTRODUCTION.format(side=side, machine=machine) + table + notes, encoding="utf-8"
    )


def count_cores() -> int:
    """Return the number of processor cores that this process may use."""
    return len(os.sched_getaffinity(0))


def format_row(program: str, setting: str, times: dict) -> list[str]:
    """Return the row of a program and a setting."""
    errors = [f"{psnr:.0f} dB" for psnr in measure_psnr(program, setting)]
    name = f"{program}, {setting}"
    if "error" in times:
        return [name, f"not measured: {times['error']}", "", "", *errors]
    rates = [f"{1 / wall:.2g} / s ({1e3 * cpu:.0f} ms)" for wall, cpu in map(times.get, SIZES)]
    wall, cpu = times["first"]
    return [name, f"{wall:.1f} s ({cpu:.1f} s)", *rates, *errors]


def measure_psnr(program: str, setting: str) -> tuple[float, float]:
    """Return the PSNR [dB] of pictures by emission and absorption, of all and of the worst."""
    from . import by_k3d, by_pyvista, by_vtk

    draw = {p.NAME: p.draw_case for p in (by_vtk, by_pyvista, by_k3d)}.get(program, draw_by_view)
    cases = [Case(name) for name in NAMES]
    squares = [
        compute_errors(draw(case, setting), case.exact)[0] ** 2
        for case in cases
        if case.renderer == "emission_absorption" and "gradients" not in case.transfer
    ]
    return tuple(-10 * np.log10([np.mean(squares), np.max(squares)]))


def draw_by_view(case: Case, setting: str) -> np.ndarray:
    """Return the picture of a case in brdfkit, with the samples and the steps of its view."""
    from . import by_brdfkit
    from .case import BEHIND

    integrator = {"type": case.renderer, **by_brdfkit.emission_absorption(case)}
    integrator |= {"steps": STEPS[setting], "jitter": True}
    light = {"type": "constant", "radiance": BEHIND}
    scene = {"type": "scene", "integrator": integrator, "light": light}
    return by_brdfkit.render_scene(case, scene, SAMPLES[setting])
