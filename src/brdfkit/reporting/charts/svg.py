"""Charts as SVG within the page: lines and dots, whose colours its style gives to their classes."""

from collections.abc import Callable
from dataclasses import dataclass
from xml.etree import ElementTree

import numpy as np

from brdfkit.fitting.compare import format_error
from brdfkit.fitting.ranking.result import TAKE
from brdfkit.materials.measured.albedos import ANGLES
from brdfkit.regression.albedo_cells import format_albedo, is_wrong
from brdfkit.regression.light import WRONG
from brdfkit.reporting.verdict.verdict import in_words


def errors_table(standings, loss, measured):
    """A row for each `Standing`, under columns of losses, of which the one that ranks is first.

    The first `Standing` is that of the fit to take. Each cell of an error is its text and whether
    it is the best of its column; each of an albedo its text and whether it is wrong beside the
    `measured` one at the same angle.
    """
    by_loss = sorted(standings[0].errors, key=lambda name: name != loss)
    rows = []
    for number, one in enumerate(standings):
        cells = [
            (format_error(one.errors[n]), one.errors[n] == min(s.errors[n] for s in standings))
            for n in by_loss
        ]
        rows.append(
            {
                "cells": cells,
                "albedos": [
                    (format_albedo(own), is_wrong(own, known))
                    for own, known in zip(one.albedos, measured, strict=True)
                ],
                "numbers": one.numbers,
                "typical": in_words(one.typical),
                "most": in_words(one.most),
                "verdict": TAKE if not number else "tied" if one.tied else "",
            }
        )
    return {
        "losses": by_loss,
        "angles": [f"{angle:g}°" for angle in ANGLES],
        "factor": WRONG,
        "measured": [(format_albedo(known), is_wrong(known)) for known in measured],
        "rows": rows,
    }


WIDTH, HEIGHT = 290, 236
COLOURS = 6  # of fits; the style has as many
STROKES = "", " dashed", " dotted"  # of fits that follow each other: equal lines are both seen
LEFT, RIGHT, TOP, BOTTOM = 48, 10, 26, 36  # margins


@dataclass(frozen=True)
class Axis:
    """`label`; `ticks`: their places and texts; `share`: what part of the axis lies before a
    value."""

    label: str
    ticks: list[tuple[float, str]]
    share: Callable


def linear(label, low, high, ticks, unit=""):
    """An `Axis` from `low` to `high`, with `ticks` at these values."""
    texts = [(tick, f"{tick:g}{unit}".replace("-", "−")) for tick in ticks]
    return Axis(label, texts, lambda value: (np.asarray(value, float) - low) / (high - low))


def fit_class(number):
    """The class of the colour and stroke of a fit by its place; the first is solid."""
    return f"fit-{number % COLOURS}" + STROKES[_stroke(number)]


def _stroke(number):
    """Which stroke a fit has: with its colour it is another one for each of 18 fits."""
    return (number + number // COLOURS) % len(STROKES)


class Chart:
    """A chart that grows: `fits`, `line`, `dots`, `bars` and `image` add to it; `svg`: its text."""

    def __init__(self, title, x, y, width=WIDTH, height=HEIGHT):
        self.x, self.y, self.width, self.height = x, y, width, height
        box = {"viewBox": f"0 0 {width} {height}", "role": "img", "aria-label": title}
        self.root = ElementTree.Element("svg", {**box, "class": "chart"})
        self._text(width / 2 + (LEFT - RIGHT) / 2, 14, title, "title")
        self._text((LEFT + width - RIGHT) / 2, height - 4, x.label, "label")
        for place, text in x.ticks:
            at = self._x(place)
            self._add("path", d=f"M{at} {TOP}V{height - BOTTOM}", kind="grid")
            self._text(at, height - BOTTOM + 14, text, "tick")
        for place, text in y.ticks:
            at = self._y(place)
            self._add("path", d=f"M{LEFT} {at}H{width - RIGHT}", kind="grid")
            self._text(LEFT - 6, at + 3.5, text, "tick left")
        if y.label:
            middle = (TOP + height - BOTTOM) / 2
            self._text(11, middle, y.label, "label", transform=f"rotate(-90 11 {middle})")

    def line(self, x, y, kind):
        """A line through points (n,), broken where they are not finite."""
        path, pen = [], "M"
        for px, py in zip(self._x(x), self._y(y), strict=True):
            known = np.isfinite(py)
            if known:
                path.append(f"{pen}{px} {py}")
            pen = "L" if known else "M"
        self._add("path", d="".join(path), kind=f"line {kind}")

    def fits(self, lines):
        """The lines (x, y) of the fits, in their order; the solid ones below, or they would hide
        others, and the first fit's above other solid ones."""
        for number in sorted(range(len(lines)), key=lambda k: (_stroke(k), -k)):
            self.line(*lines[number], fit_class(number))

    def dots(self, x, y, kind):
        """Round dots at points (n,)."""
        places = zip(self._x(x), self._y(y), strict=True)
        path = "".join(f"M{px} {py}h0" for px, py in places if np.isfinite(py))
        self._add("path", d=path, kind=f"dots {kind}")

    def bars(self, x, low, high, kind):
        """Upright bars from `low` to `high` (n,)."""
        places = zip(self._x(x), self._y(low), self._y(high), strict=True)
        path = "".join(f"M{px} {a}V{b}" for px, a, b in places if np.isfinite([a, b]).all())
        self._add("path", d=path, kind=f"bars {kind}")

    def upright(self, x, kind):
        """A line across the chart at `x`."""
        self._add("path", d=f"M{self._x(x)} {TOP}V{self.height - BOTTOM}", kind=kind)

    def across(self, y, kind):
        """A line along the chart at `y`."""
        self._add("path", d=f"M{LEFT} {self._y(y)}H{self.width - RIGHT}", kind=kind)

    def image(self, address):
        """A picture that fills the chart, its pixels as they are."""
        size = {"width": self.width - LEFT - RIGHT, "height": self.height - TOP - BOTTOM}
        place = {"x": LEFT, "y": TOP, "preserveAspectRatio": "none", "href": address}
        self._add("image", kind="pixels", **size, **place)

    @property
    def svg(self):
        """The chart as text, escaped."""
        return ElementTree.tostring(self.root, encoding="unicode")

    def _x(self, value):
        return np.round(LEFT + self.x.share(value) * (self.width - LEFT - RIGHT), 1)

    def _y(self, value):
        bottom = self.height - BOTTOM
        return np.round(bottom - self.y.share(value) * (bottom - TOP), 1)

    def _text(self, x, y, text, kind, **others):
        self._add("text", x=x, y=y, kind=kind, **others).text = text

    def _add(self, tag, kind, **attributes):
        texts = {name: str(value) for name, value in attributes.items()}
        return ElementTree.SubElement(self.root, tag, {"class": kind, **texts})
