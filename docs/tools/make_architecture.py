"""Draw `docs/architecture.png`, the layers of the library with their imports.

python docs/tools/make_architecture.py

The layers are those that `make lint` holds (pyproject.toml), the arrows the imports that the code
has, at the top of a file or within a function. An import that other arrows lead to as well is left
out. A room is the wider the more lines it has.
"""

import tomllib
from pathlib import Path

import grimp
import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import FancyArrowPatch, FancyBboxPatch

ROOT = Path(__file__).resolve().parents[2]
PACKAGE = ROOT / "src" / "brdfkit"
ROW, GAP = 0.74, 0.2  # inches
LABELS = 2.5  # inches for what a row is for
PAPER, INK, LINE = "#f5f1e8", "#2b2b2b", "#8a5a2b"
GROUPS = {  # what a row of rooms is for, by one of them
    "cli": "what people type",
    "inverse": "numbers from pictures; reports",
    "checks": "verbs: what people call",
    "materials": "nouns: what people name",
    "regression": "what a fit and what Mitsuba runs",
    "model": "what a model is made of",
    "images": "pictures; claims of theses",
    "core": "the ground everyone stands on",
    "plugins": "the door to plugins/",
}


def layers():
    """The rooms of each layer, from the top."""
    contracts = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["importlinter"]
    rows = contracts["contracts"][0]["layers"]
    return [[room.strip() for room in row.replace(":", "|").split("|")] for row in rows]


def lines(room):
    """Lines of a room, a file or a folder."""
    folder = PACKAGE / room
    files = folder.rglob("*.py") if folder.is_dir() else [folder.with_suffix(".py")]
    return sum(len(file.read_text(encoding="utf-8").splitlines()) for file in files)


def imports():
    """The pairs (room, room) of which a file of the one imports one of the other."""
    graph = grimp.build_graph("brdfkit", cache_dir=None)
    found = set()
    for file in graph.modules:
        for other in graph.find_modules_directly_imported_by(file):
            pair = tuple([*name.split("."), ""][1] for name in (file, other))
            if pair[0] != pair[1] and all(pair):
                found.add(pair)
    return sorted(found)


def direct(found):
    """The imports that no chain of others implies."""
    below = {}
    for room, other in found:
        below.setdefault(room, set()).add(other)

    def reaches(room, goal):
        return any(o == goal or reaches(o, goal) for o in below.get(room, ()))

    return [(a, b) for a, b in found if not any(reaches(o, b) for o in below[a] - {b})]


def draw():
    """The picture as a matplotlib `Figure`."""
    rows = layers()
    width_of = {room: _width(room) for rooms in rows for room in rooms}
    long = [sum(width_of[room] + GAP for room in rooms) for rooms in rows]
    whole = LABELS + max(long)
    figure = Figure(figsize=(whole, ROW * len(rows) + 0.7), facecolor="white")
    axes = figure.add_axes((0, 0, 1, 1))
    axes.set(xlim=(0, whole), ylim=(0, ROW * len(rows) + 0.7))
    axes.set_axis_off()
    places = {}
    for number, rooms in enumerate(rows):
        y = ROW * (len(rows) - number) - 0.1
        x = (LABELS + whole - long[number]) / 2
        for room in rooms:
            places[room] = (x + width_of[room] / 2, y, width_of[room])
            x += width_of[room] + GAP
        label = next((text for room, text in GROUPS.items() if room in rooms), "")
        axes.text(0.2, y, label, va="center", size=9, color="0.45", style="italic")
    for room, other in direct(imports()):
        _arrow(axes, places[room], places[other])
    for room, (x, y, width) in places.items():
        _room(axes, room, x, y, width)
    axes.text(
        0.2,
        ROW * len(rows) + 0.42,
        "The house: every arrow, an import, runs downwards",
        size=13,
        color=INK,
        va="center",
    )
    return figure


def _width(room):
    """The width of a room [inches], which its name fits into."""
    return max(0.6 + 0.022 * np.sqrt(lines(room)), 0.3 + 0.08 * len(room))


def _room(axes, room, x, y, width):
    box = (x - width / 2, y - 0.2), width, 0.4
    style = {"boxstyle": "round,pad=0.02", "facecolor": PAPER, "edgecolor": LINE, "zorder": 3}
    axes.add_patch(FancyBboxPatch(*box, linewidth=1.0, **style))
    name = f"{room}/" if (PACKAGE / room).is_dir() else room
    axes.text(x, y + 0.05, name, ha="center", va="center", size=9, color=INK, zorder=4)
    axes.text(
        x, y - 0.12, f"{lines(room):,}", ha="center", va="center", size=6.5, color="0.5", zorder=4
    )


def _arrow(axes, start, end):
    (x0, y0, _), (x1, y1, _) = start, end
    far = y0 - y1 > 1.5 * ROW
    bend = (0.22 if x1 >= x0 else -0.22) if far else 0.0
    style = {"arrowstyle": "-|>", "mutation_scale": 9, "color": LINE, "alpha": 0.7}
    style |= {"linewidth": 1.0, "zorder": 1, "connectionstyle": f"arc3,rad={bend}"}
    axes.add_patch(FancyArrowPatch((x0, y0 - 0.21), (x1, y1 + 0.23), **style))


if __name__ == "__main__":
    draw().savefig(Path(__file__).parents[1] / "architecture.png", dpi=110)
