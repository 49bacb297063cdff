"""Makes the comment at the head of an exported file: where the material is from, and its widths."""

from __future__ import annotations

from typing import Any, cast

from brdfkit.core import catalogue
from brdfkit.core.names import to_printable
from brdfkit.core.version import __version__
from brdfkit.exporting.ggx_sum import to_ggx_sum
from brdfkit.exporting.loss import Loss
from brdfkit.exporting.target import Held
from brdfkit.model import Model
from brdfkit.regression import Fit

LICENCE = "Licence of the measured data: "
BY_ROUGHNESS = "disney", "gltf", "openpbr"  # models with GGX's widths by other parameters


def make_comment(thing: Fit | Model, held: Held, loss: Loss, command: str) -> list[str]:
    """Return the lines of the comment: source, licence, widths, losses, version and command."""
    lines = [f"{_describe_source(thing)}, exported by brdfkit {__version__}"]
    if isinstance(thing, Fit) and (licence := find_licence(thing.data)):
        lines.append(f"{LICENCE}{licence}")
    # A table has the widths of what it was made of
    shown = held.content if isinstance(held.content, Model) else held.drawn
    widths = _list_widths(shown if isinstance(shown, Model) else thing.rgb)
    for number, (alpha_u, alpha_v) in enumerate(widths, 1):
        words = f"alpha_u = {alpha_u:.6g}, alpha_v = {alpha_v:.6g}"
        lines.append(f"Highlight {number}: GGX, {words} (along x, the tangent, and y)")
    lost = f"Lost: {'; '.join(held.changes)} ({loss})"
    lines.append(lost if held.changes else "Nothing was lost.")
    return [*map(to_plain_line, lines), to_plain_line(f"Made by: {command}")]


def _list_widths(model: Model) -> list[tuple[float, float]]:
    """Return the widths along x and y of each highlight of GGX, apart from coats."""
    if content := to_ggx_sum(model):
        return [(lobe.alpha_u, lobe.alpha_v) for lobe in content.lobes]
    if model.type_name() not in BY_ROUGHNESS:
        return []
    slopes = cast(Any, model).slopes()
    return [(float(slopes.alpha_u), float(slopes.alpha_v))]


def to_plain_line(text: str) -> str:
    """Return a text on one line that ends no comment of any language.

    A name in a file that somebody sent must not become code.

    >>> to_plain_line("a \\\\ and */")
    'a / and * /'
    """
    line = to_printable(" ".join(text.split()))
    for end, harmless in (("\\", "/"), ('"""', "'''"), ("*/", "* /"), ("-->", "-- >")):
        line = line.replace(end, harmless)
    return line


def _describe_source(thing: Fit | Model) -> str:
    """Return in words what was exported."""
    if isinstance(thing, Fit):
        return f"{thing.model.label()} fitted to {thing.data}"
    return f"The model {thing.label()}"


def find_licence(data: str) -> str:
    """Return the licence of a material that brdfkit knows by its name, and "" of any other."""
    known = catalogue.list_materials()
    return known[data].licence if data in known else ""
