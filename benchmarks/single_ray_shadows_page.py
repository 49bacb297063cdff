"""Writes the page of `single_ray_shadows.py` from its results."""

from pathlib import Path

import numpy as np
import single_ray_shadows_figure as figure

PAGE = Path(__file__).parents[1] / "docs" / "single_ray_shadows.md"
SHOWN = (
    "linear 1/20", "base 1/20", "discrete 1/20", "convex 1/20", "split 1/5", "split 1/10",
    "split, 19 cones, 1/10", "quilez", "aaltonen",
    "monte_carlo 4", "monte_carlo 16", "monte_carlo 64",
)  # fmt: skip
MARCHES = "base", "linear", "discrete", "convex"

INTRODUCTION = """# Errors of single-ray shadows

Made by `python benchmarks/single_ray_shadows.py`. Errors are root mean squares of the share of the
light that is seen, from the light that truly arrives: 2048 rays (512 in frames) from the point
itself to a sphere. Times are ratios within one run, in one thread. The marches are those of
[Bálint et al. 2019], who published no errors; `quilez` and `aaltonen` are those of [Quílez 2010]
and [Aaltonen 2018]. What the errors look like: [the gallery](distance_fields.md); what the thesis
claims: [its page](reproduce/balint2019.md).

![Errors over evaluations, and shadows on a ground](single_ray_shadows.png)
"""
OCCLUDERS = """## What came out

- The error is the model's, one straight edge, and not the march's: ε = 1/10 and 1/256 have the
  same. Small and pointed occluders are too dark, several and thin ones leak light.
- `split`, seven narrower cones, divides it by 2 to 6 for two to three times the evaluations. What
  is left then is mostly the ball about the point, from which the cones start, here 0.02 wide: rays
  that know of no ball have the same error after about the same time. Two straight edges at the two
  smallest minima of f/ρ, and sums over the section at the minimum, were tried too, and were worse
  on most kinds at equal cost.
- `quilez` and `aaltonen` err as much as one random ray does, always towards dark.
- Derivatives are exact for the model; where it is far from the truth they may have the wrong sign,
  as that by the radius of a light behind a small sphere. Those of `split` have the right one.

## Occluders

4096 random cones each, with a light at 6 whose radius is 0.2, 1 or 2; an occluder covers a part of
nearly every one of them (`occluders.py`). The row τ(r_min) is what the marches approach: its error
is that of the model, a single straight edge. Each cell: error, and in brackets the mean number of
evaluations of the distance.
"""
MODEL = """## Against the model

The smallest and largest difference from τ(r_min), over ε = 1/20: 0 to 1 is claimed, for `discrete`
-1 to 1.
"""
FRAMES = """## Frames

Shadows on the ground under a cube, a simple scene (three spheres, a box) and a complicated one (25
objects), by lights of two radii (`ground_scenes.py`), most of it fully lit. Each cell: error, and
in brackets the time over that of one hard shadow ray of the same field.
"""
EQUAL = """## At equal error

How many times as long as the method rays take that have its error (interpolated between 1, 2, 4 ...
128 rays).
"""
GRADIENTS = """## Derivatives

By Dr.Jit (ε = 1/20), by finite differences of the same method (ε = 1/256, 1/2000), and by
differences of the true light over a wider step.
"""


def write_page(results):
    """Write the page and its figure from the `results` by part."""
    parts = [
        INTRODUCTION, OCCLUDERS, make_occluders_table(results), MODEL, make_model_table(results),
        FRAMES, make_frames_table(results), EQUAL, make_equal_error_table(results), GRADIENTS,
        make_gradients_table(results),
    ]  # fmt: skip
    PAGE.write_text("\n".join(parts), encoding="utf-8")
    figure.draw_figure(results).savefig(PAGE.with_suffix(".png"), dpi=90)


def make_table(head, rows):
    """Return a Markdown table; `head`: texts of its columns, `rows`: texts of cells."""
    lines = [head, ["---"] * len(head), *rows]
    return "".join(f"| {' | '.join(map(str, line))} |\n" for line in lines)


def select_parts(results, kind):
    """Return the results of parts of one `kind`, by the rest of their names."""
    return {name.split(" ", 1)[1]: p for name, p in results.items() if name.startswith(kind + " ")}


def make_occluders_table(results):
    kinds = select_parts(results, "occluder")

    def format_cell(row):
        n = row["evaluations"]
        return f"{row['rmse']:.3f}" + (f" ({n:.0f})" if n else "")

    rows = [
        [label, *(format_cell(k[label]) for k in kinds.values())] for label in (*SHOWN, "τ(r_min)")
    ]
    return make_table(["", *(name.replace("_", " ") for name in kinds)], rows)


def make_model_table(results):
    kinds = select_parts(results, "occluder")

    def format_cell(row):
        return "{:.2f} to {:.2f}".format(*(v + 0.0 for v in row["from model"]))

    rows = [[m, *(format_cell(k[f"{m} 1/20"]) for k in kinds.values())] for m in MARCHES]
    return make_table(["", *(name.replace("_", " ") for name in kinds)], rows)


def make_frames_table(results):
    found = select_parts(results, "frame")

    def format_cell(rows, label):
        times = rows[label]["seconds"] / rows["monte_carlo 1"]["seconds"]
        return f"{rows[label]['rmse']:.4f} ({times:.1f})"

    rows = [[label, *(format_cell(f, label) for f in found.values())] for label in SHOWN]
    return make_table(["", *found], rows)


def make_equal_error_table(results):
    found = select_parts(results, "frame") | select_parts(results, "occluder")
    shown = [label for label in SHOWN if not label.startswith(("monte", "quilez", "aaltonen"))]
    rows = [
        [n.replace("_", " "), *(compute_speedup(f, label) for label in shown)]
        for n, f in found.items()
    ]
    return make_table(["", *shown], rows)


def compute_speedup(rows, label):
    """Return how many times as long as a method rays take with its error, as text."""
    rays = [row for name, row in rows.items() if name.startswith("monte_carlo")]
    error, seconds = (np.log([row[key] for row in rays]) for key in ("rmse", "seconds"))
    own = rows[label]
    at = np.interp(-np.log(own["rmse"]), -error, seconds)
    beyond = "> " if np.log(own["rmse"]) < error.min() else ""
    return f"{beyond}{np.exp(at) / own['seconds']:.1f}"


def make_gradients_table(results):
    columns = ["linear", "linear, difference", "split", "split, difference", "truth"]
    found = results["gradients"]
    return make_table(
        ["", *columns], [[n, *(f"{g[c]:.4f}" for c in columns)] for n, g in found.items()]
    )
