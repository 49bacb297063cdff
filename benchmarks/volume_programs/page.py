"""Writes docs/volume_programs.md and its figure, from the pictures of the programs."""

from pathlib import Path

import numpy as np

from . import figure
from .case import INDEX, NAMES, Case

PAGE = Path(__file__).parents[2] / "docs/volume_programs.md"
INTRODUCTION = """# The same volume in every program

Made by `python benchmarks/compare_volume_programs.py`. The
[conformance set](../data/conformance/README.md) has eleven volumes with exact pictures, by
quadrature to 1e-9, of 48² rays through the middles of pixels. Here is how far the pictures of five
programs are from them, and why.

![Exact pictures, those of the programs, and differences](volume_programs.png)

Left: exact. Then each program's picture, and its difference from the exact one, ten times as large:
grey is equal. K3D lights volumes and Mitsuba has no media that glow, so of these the opacity of the
whole is shown and compared, in grey.
"""
ERRORS = """## Errors

In percent of white: root mean square, and in brackets the largest of all pixels.
"""
FINDINGS = """## Why they differ

- **The unit of opacity is nearly all of it.** A program that wants an opacity has to be told of
  what thickness. VTK's `ScalarOpacityUnitDistance` is 1; PyVista's `opacity_unit_distance` is the
  volume's diagonal over its mean number of voxels less 1; K3D's is the box's edge over
  `alpha_coef`, 50. So the same points are other volumes ("typed in"), and with the opacity
  1 - exp(-σ_t d) for the program's own d they are the same ("right unit"). The other way round,
  `TransferFunction.from_opacity(..., unit_distance=d)` reads points of VTK's: that is the case
  `opacity`, where VTK's points stand as they are.
- **The box ends at the centres of the outermost voxels in VTK and PyVista**, and at their faces in
  brdfkit, Mitsuba and K3D. Voxels repeated beyond the faces and six clipping planes mend that in
  VTK ("careful"); its cropping planes were off by up to 0.4 of a voxel.
- **Steps.** VTK's own samples are so far apart that they miss a narrow peak (`layer`);
  `SetSampleDistance` mends that. brdfkit has no more samples, but where the function has peaks or
  jumps that a step would jump over, it takes the function's means between the values at the ends
  of a step [Engel et al. 2001]: it is 1.2 % of white off at most, and was 48 % by samples. Labels
  (`labels`) are not mended by that, as there is nothing between them: 1.9 % at edges, 0.1 % in
  2048 steps.
- **Look-up first, or interpolation first.** All interpolate values, and look them up then. But
  Mitsuba's gridvolume holds σ_t itself, looked up at the voxels, so that a step becomes a ramp
  (`step`), and a thin layer is what voxels happen to be in it (`layer`). brdfkit's volume
  `transfer_function` in Mitsuba's own `volpath` has no such error: what is left is the noise of
  {paths} paths per pixel, {noise} % in the mean of all cases.
- **Gradients.** VTK's gradient opacity is over the change of the value per mean edge of a voxel,
  not per unit of length, and what is steeper than a quarter of the range of values counts as that.
  brdfkit takes magnitudes at the voxels and interpolates these (`gradients`).
- **Isosurfaces.** A mesh of `vtkFlyingEdges3D` ("careful") is exact (`saddle`); VTK's ray casting
  shades otherwise, by up to 15 %. Why was not found out.
- **Interpolation.** `vtkVolumeProperty` takes the nearest voxel unless it is told otherwise, and
  PyVista leaves it so: without `actor.prop.interpolation_type = "linear"` its volumes are blocks
  (`layer`, `step`, `maximum`). In the columns of VTK it is linear.
- **Tables.** PyVista has 256 opacities in 8 bits for the range, twice the error of VTK (`ball`).
- **Colours.** VTK, PyVista and K3D mix the numbers that they are given, here linear ones. Colours
  of a screen, typed in, are mixed otherwise than by brdfkit, which mixes light.
- **8 bits.** 0.1 to 0.2 %, which VTK and K3D are off at best, are mostly rounding.
"""
SETTINGS = """## Settings
"""


def write_page(programs, pictures):
    """Write the page and its figure; `pictures`: RGB and opacity by (case, program, setting)."""
    deviation, paths = estimate_noise(programs)
    findings = FINDINGS.format(noise=f"{100 * deviation:.1g}", paths=paths)
    settings = [
        f"- {p.NAME} {p.find_version()}, {setting}: {words}"
        for p in programs
        for setting, words in p.SETTINGS.items()
    ]
    parts = [
        INTRODUCTION,
        ERRORS,
        make_errors_table(programs, pictures),
        findings,
        list_cases(),
        SETTINGS,
    ]
    PAGE.write_text("\n".join(parts + settings) + "\n", encoding="utf-8")
    figure.draw_figure(pictures).savefig(PAGE.with_suffix(".png"), dpi=90)


def make_errors_table(programs, pictures):
    """Return the table of errors with a row for each case and a column for each setting."""
    columns = [(p.NAME, setting) for p in programs for setting in p.SETTINGS]

    def format_cell(name, column):
        found = pictures.get((name, *column))
        if found is None:
            return ""
        rms, most = compute_errors(found, Case(name).exact)
        return f"{format_percent(rms)} ({format_percent(most)})"

    head = ["", *(f"{program}, {setting}" for program, setting in columns)]
    rows = [[name, *(format_cell(name, column) for column in columns)] for name in NAMES]
    lines = [head, ["---"] * len(head), *rows]
    return "".join(f"| {' | '.join(line)} |\n" for line in lines)


def format_percent(share):
    if share < 1e-4:
        return "< 0.01"
    return f"{100 * share:.{0 if share > 0.0995 else 1 if share > 0.00995 else 2}f}"


def list_cases():
    """Return the section that describes the cases."""
    told = [f"- `{name}`: {INDEX[name]['what']}" for name in NAMES]
    return "## Cases\n\n" + "\n".join(told) + "\n"


def compute_errors(picture, exact):
    """Return the root mean square and the largest error of RGB, or of the opacity without RGB."""
    part = figure.choose_channels(picture)
    difference = (picture - exact)[..., part]
    return float(np.sqrt(np.mean(difference**2))), float(np.abs(difference).max())


def estimate_noise(programs):
    """Return the root mean square noise of Mitsuba's paths, and the number of paths per pixel."""
    samples = next(p.SAMPLES for p in programs if hasattr(p, "SAMPLES"))
    seen = [n for n in NAMES if INDEX[n]["renderer"] == "emission_absorption"]
    a = np.stack([Case(n).exact[..., 3] for n in seen])
    return float(np.sqrt(np.mean(a * (1 - a)) / samples)), samples
