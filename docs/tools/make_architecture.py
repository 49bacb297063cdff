"""Draws `docs/architecture.png`, the layers of the library with their imports.

python docs/tools/make_architecture.py

The layers are those that `make lint` checks (pyproject.toml). A box is a part of the package, a
file or a folder, and is wider the more lines it has. An arrow is an import at the top of a file or
within a function. Imports that a chain of other arrows implies are left out.
"""

import tomllib
from pathlib import Path

import grimp
import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import FancyArrowPatch, FancyBboxPatch

ROOT = Path(__file__).resolve().parents[2]
PACKAGE = ROOT / "src" / "brdfkit"
ROW, GAP = 0.74, 0.2  # height of a row, and space between boxes [inches]
LABELS = 2.5  # width of the labels of rows [inches]
PAPER, INK, LINE = "#f5f1e8", "#2b2b2b", "#8a5a2b"
GROUPS = {  # labels of rows, by one of the parts in the row
    "cli": "what people type",
    "inverse": "numbers from pictures; reports; exports",
    "checks": "verbs: what people call",
    "materials": "nouns: what people name",
    "regression": "what a fit and what Mitsuba runs",
    "model": "what a model is made of",
    "images": "pictures; claims of theses",
    "core": "the ground everyone stands on",
    "plugins": "the door to plugins/",
}


def read_layers():
    """Return the names of the parts in each layer, from the top."""
    contracts = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["importlinter"]
    rows = contracts["contracts"][0]["layers"]
    return [[part.strip() for part in row.replace(":", "|").split("|")] for row in rows]


def count_lines(part):
    """Return the number of lines of a part, a file or a folder."""
    folder = PACKAGE / part
    files = folder.rglob("*.py") if folder.is_dir() else [folder.with_suffix(".py")]
    return sum(len(file.read_text(encoding="utf-8").splitlines()) for file in files)


def find_imports():
    """Return the pairs of parts (importing, imported) between whose files there is an import."""
    graph = grimp.build_graph("brdfkit", cache_dir=None)
    found = set()
    for file in graph.modules:
        for other in graph.find_modules_directly_imported_by(file):
            pair = tuple([*name.split("."), ""][1] for name in (file, other))
            if pair[0] != pair[1] and all(pair):
                found.add(pair)
    return sorted(found)


def remove_implied_imports(found):
    """Return the pairs of parts without those that a chain of other pairs implies."""
    below = {}
    for part, other in found:
        below.setdefault(part, set()).add(other)

    def reaches(part, goal):
        """Return whether a chain of imports leads from one part to another."""
        return any(o == goal or reaches(o, goal) for o in below.get(part, ()))

    return [(a, b) for a, b in found if not any(reaches(o, b) for o in below[a] - {b})]


def draw_architecture():
    """Return the picture as a matplotlib `Figure`."""
    rows = read_layers()
    width_of = {part: _compute_width(part) for parts in rows for part in parts}
    long = [sum(width_of[part] + GAP for part in parts) for parts in rows]
    whole = LABELS + max(long)
    figure = Figure(figsize=(whole, ROW * len(rows) + 0.7), facecolor="white")
    axes = figure.add_axes((0, 0, 1, 1))
    axes.set(xlim=(0, whole), ylim=(0, ROW * len(rows) + 0.7))
    axes.set_axis_off()
    places = {}
    for number, parts in enumerate(rows):
        y = ROW * (len(rows) - number) - 0.1
        x = (LABELS + whole - long[number]) / 2
        for part in parts:
            places[part] = (x + width_of[part] / 2, y, width_of[part])
            x += width_of[part] + GAP
        label = next((text for part, text in GROUPS.items() if part in parts), "")
        axes.text(0.2, y, label, va="center", size=9, color="0.45", style="italic")
    for part, other in remove_implied_imports(find_imports()):
        _draw_arrow(axes, places[part], places[other])
    for part, (x, y, width) in places.items():
        _draw_part(axes, part, x, y, width)
    axes.text(
        0.2,
        ROW * len(rows) + 0.42,
        "The house: every arrow, an import, runs downwards",
        size=13,
        color=INK,
        va="center",
    )
    return figure


def _compute_width(part):
    """Return the width of a part's box [inches], by its lines, at least that of its name."""
    return max(0.6 + 0.022 * np.sqrt(count_lines(part)), 0.3 + 0.08 * len(part))


def _draw_part(axes, part, x, y, width):
    box = (x - width / 2, y - 0.2), width, 0.4
    style = {"boxstyle": "round,pad=0.02", "facecolor": PAPER, "edgecolor": LINE, "zorder": 3}
    axes.add_patch(FancyBboxPatch(*box, linewidth=1.0, **style))
    name = f"{part}/" if (PACKAGE / part).is_dir() else part
    axes.text(x, y + 0.05, name, ha="center", va="center", size=9, color=INK, zorder=4)
    axes.text(
        x,
        y - 0.12,
        f"{count_lines(part):,}",
        ha="center",
        va="center",
        size=6.5,
        color="0.5",
        zorder=4,
    )


def _draw_arrow(axes, start, end):
    (x0, y0, _), (x1, y1, _) = start, end
    far = y0 - y1 > 1.5 * ROW
    bend = (0.22 if x1 >= x0 else -0.22) if far else 0.0
    style = {"arrowstyle": "-|>", "mutation_scale": 9, "color": LINE, "alpha": 0.7}
    style |= {"linewidth": 1.0, "zorder": 1, "connectionstyle": f"arc3,rad={bend}"}
    axes.add_patch(FancyArrowPatch((x0, y0 - 0.21), (x1, y1 + 0.23), **style))


if __name__ == "__main__":
    draw_architecture().savefig(Path(__file__).parents[1] / "architecture.png", dpi=110)
