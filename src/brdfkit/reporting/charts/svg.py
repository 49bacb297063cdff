"""Draws charts as SVG: axes, lines, dots, bars and images.

The style sheet of the page sets their colours, by CSS classes.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Any
from xml.etree import ElementTree

import numpy as np

from brdfkit.core.array_types import ArrayLike

WIDTH, HEIGHT = 290, 236
LEFT, RIGHT, TOP, BOTTOM = 48, 10, 26, 36  # margins around the plotted area [pixels]
COLOURS = 6  # number of colours for fits, which the page's style sheet defines
# CSS classes of strokes, which fits take in turn, so that lines on top of each other stay visible
STROKES = "", " dashed", " dotted"


@dataclass(frozen=True)
class Axis:
    """An axis of a chart.

    label : the text beside the axis.
    ticks : the values and texts of the ticks.
    share : the function from a value to its position on the axis, from 0 to 1.
    """

    label: str
    ticks: Sequence[tuple[float, str]]
    share: Callable[[Any], Any]


def make_linear_axis(
    label: str, low: float, high: float, ticks: Iterable[float], unit: str = ""
) -> Axis:
    """Return a linear `Axis` from `low` to `high`, with ticks labelled by value and `unit`."""
    texts = [(tick, f"{tick:g}{unit}".replace("-", "−")) for tick in ticks]
    return Axis(label, texts, lambda value: (np.asarray(value, float) - low) / (high - low))


def choose_css_class(number: int) -> str:
    """Return the CSS classes for the colour and stroke of the fit with this number.

    The first 18 fits all look different, and the first one is solid.
    """
    return f"fit-{number % COLOURS}" + STROKES[_choose_stroke(number)]


def _choose_stroke(number: int) -> int:
    """Return the index in `STROKES` of the stroke of the fit with this number."""
    return (number + number // COLOURS) % len(STROKES)


class Chart:
    """A chart with two axes, to which lines, dots, bars and images are added.

    `title`: the text above the chart; `x`, `y`: its axes; `width`, `height`: its size [pixels].
    Methods take values on the axes, and a `kind`, the CSS class that decides the colour.
    """

    def __init__(
        self, title: str, x: Axis, y: Axis, width: float = WIDTH, height: float = HEIGHT
    ) -> None:
        self.x, self.y, self.width, self.height = x, y, width, height
        box = {"viewBox": f"0 0 {width} {height}", "role": "img", "aria-label": title}
        self.root = ElementTree.Element("svg", {**box, "class": "chart"})
        self._add_text(width / 2 + (LEFT - RIGHT) / 2, 14, title, "title")
        self._add_text((LEFT + width - RIGHT) / 2, height - 4, x.label, "label")
        for value, text in x.ticks:
            at = self._to_x(value)
            self._add_element("path", d=f"M{at} {TOP}V{height - BOTTOM}", kind="grid")
            self._add_text(at, height - BOTTOM + 14, text, "tick")
        for value, text in y.ticks:
            at = self._to_y(value)
            self._add_element("path", d=f"M{LEFT} {at}H{width - RIGHT}", kind="grid")
            self._add_text(LEFT - 6, at + 3.5, text, "tick left")
        if y.label:
            middle = (TOP + height - BOTTOM) / 2
            self._add_text(11, middle, y.label, "label", transform=f"rotate(-90 11 {middle})")

    def add_line(self, x: ArrayLike, y: ArrayLike, kind: str) -> None:
        """Add a line through points `x`, `y` (n,), interrupted where they are not finite."""
        path, pen = [], "M"
        for px, py in zip(self._to_x(x), self._to_y(y), strict=True):
            known = np.isfinite(py)
            if known:
                path.append(f"{pen}{px} {py}")
            pen = "L" if known else "M"
        self._add_element("path", d="".join(path), kind=f"line {kind}")

    def add_fits(self, lines: Sequence[tuple[ArrayLike, ArrayLike]]) -> None:
        """Add the lines of all fits, pairs (x, y) of arrays in the order of the fits.

        Solid lines are drawn first, because they would hide the others. The line of the first fit
        is drawn above the other solid ones.
        """
        for number in sorted(range(len(lines)), key=lambda k: (_choose_stroke(k), -k)):
            self.add_line(*lines[number], choose_css_class(number))

    def add_dots(self, x: ArrayLike, y: ArrayLike, kind: str) -> None:
        """Add round dots at points `x`, `y` (n,); those that are not finite are left out."""
        places = zip(self._to_x(x), self._to_y(y), strict=True)
        path = "".join(f"M{px} {py}h0" for px, py in places if np.isfinite(py))
        self._add_element("path", d=path, kind=f"dots {kind}")

    def add_bars(self, x: ArrayLike, low: ArrayLike, high: ArrayLike, kind: str) -> None:
        """Add vertical bars at `x` (n,), from `low` to `high` (n,)."""
        places = zip(self._to_x(x), self._to_y(low), self._to_y(high), strict=True)
        path = "".join(f"M{px} {a}V{b}" for px, a, b in places if np.isfinite([a, b]).all())
        self._add_element("path", d=path, kind=f"bars {kind}")

    def add_vertical_line(self, x: float, kind: str) -> None:
        """Add a vertical line through the whole chart at the value `x`."""
        self._add_element("path", d=f"M{self._to_x(x)} {TOP}V{self.height - BOTTOM}", kind=kind)

    def add_horizontal_line(self, y: float, kind: str) -> None:
        """Add a horizontal line through the whole chart at the value `y`."""
        self._add_element("path", d=f"M{LEFT} {self._to_y(y)}H{self.width - RIGHT}", kind=kind)

    def add_image(self, address: str) -> None:
        """Add a picture that fills the chart, given by its `data:` address."""
        size = {"width": self.width - LEFT - RIGHT, "height": self.height - TOP - BOTTOM}
        place = {"x": LEFT, "y": TOP, "preserveAspectRatio": "none", "href": address}
        self._add_element("image", kind="pixels", **size, **place)

    @property
    def svg(self) -> str:
        """The chart as SVG text, with special characters escaped."""
        return ElementTree.tostring(self.root, encoding="unicode")

    def _to_x(self, value: ArrayLike) -> Any:
        """Return the horizontal positions [pixels] of values on the x axis."""
        return np.round(LEFT + self.x.share(value) * (self.width - LEFT - RIGHT), 1)

    def _to_y(self, value: ArrayLike) -> Any:
        """Return the vertical positions [pixels] of values on the y axis."""
        bottom = self.height - BOTTOM
        return np.round(bottom - self.y.share(value) * (bottom - TOP), 1)

    def _add_text(self, x: float, y: float, text: str, kind: str, **others: object) -> None:
        """Add a `text` at a position [pixels], of the CSS class `kind`."""
        self._add_element("text", x=x, y=y, kind=kind, **others).text = text

    def _add_element(self, tag: str, kind: str, **attributes: object) -> ElementTree.Element:
        """Add an SVG element with a `tag`, such as "path", and the CSS class `kind`."""
        texts = {name: str(value) for name, value in attributes.items()}
        return ElementTree.SubElement(self.root, tag, {"class": kind, **texts})
