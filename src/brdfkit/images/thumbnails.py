"""Small pictures of any BRDF, for notebooks and reports: a ball, and the lobes as polar plots."""

import io
import math
from collections.abc import Callable
from functools import partial
from html import escape
from typing import Any, TypeAlias

import numpy as np

from brdfkit.core.array_types import AnyArray, ArrayLike
from brdfkit.core.colours import luminance, to_srgb
from brdfkit.core.documents import Picture
from brdfkit.core.geometry.directions import from_angles
from brdfkit.images.ball.ball import draw_ball
from brdfkit.images.ball.half_vectors import Brdf
from brdfkit.images.hatching import hatch

BALL_SIZE = 92  # pixels
LARGEST_RANGE = 5  # largest ratio [decades] of the value at the rim to that at the centre
# The distance of the smallest value from the centre, relative to the range of values. Without it
# both sides of a line would meet at the centre, and a dark lobe would look like a wedge
MARGIN = 0.2


# Tells of direction pairs (n, 3) whether their values were measured, 0, inferred, 1, or guessed, 2
Evidence: TypeAlias = Callable[[Any, Any], Any]


def make_thumbnails(
    name: str, brdf: Brdf, evidence: Evidence | None = None
) -> tuple[Picture, Picture]:
    """Return two pictures of a BRDF, a ball and a polar plot of its lobes.

    `brdf` takes direction pairs (n, 3) and returns values (n, 1 or 3) in sr⁻¹; `name` is the
    material's name in the descriptions of the pictures. With `evidence`, the ball is hatched where
    its light was inferred or guessed, and the lines of the lobes are broken.
    """
    return make_ball_picture(name, brdf, evidence), make_lobe_picture(name, brdf, evidence)


def make_ball_picture(name: str, brdf: Brdf, evidence: Evidence | None = None) -> Picture:
    """Return a picture of a ball made of the material `name` with this BRDF, on no background."""
    says = f"a ball of {name} under two softboxes"
    if evidence:
        says += "; sparse stripes: inferred from measurements, dense stripes: guessed"
    return Picture(partial(_draw_ball_png, brdf, evidence), says, BALL_SIZE)


def _draw_ball_png(brdf: Brdf, evidence: Evidence | None) -> bytes:
    """Draw a ball with this BRDF, and return the picture as the bytes of a PNG."""
    from PIL import Image

    linear, cover = draw_ball(brdf, BALL_SIZE)
    rgb = np.broadcast_to(to_srgb(linear), (BALL_SIZE, BALL_SIZE, 3)) * 255 + 0.5
    colours = rgb.astype(np.uint8)
    if evidence:
        levels = find_levels(brdf, evidence, BALL_SIZE // 2)
        colours = hatch(colours, levels.repeat(2, axis=0).repeat(2, axis=1))
    alpha = (cover * 255 + 0.5).astype(np.uint8)
    stream = io.BytesIO()
    Image.fromarray(np.dstack([colours, alpha])).save(stream, "PNG")
    return stream.getvalue()


def find_levels(brdf: Brdf, evidence: Evidence, side: int) -> AnyArray:
    """Return for each pixel (side, side) of a ball what most of its light is.

    It is 2 if at least half of the light was guessed, 1 if at least half was guessed or inferred.
    """

    def divide(wi: Any, wo: Any) -> AnyArray:
        values = luminance(np.maximum(brdf(wi, wo), 0))
        kinds = evidence(wi, wo)
        return np.stack([values, values * (kinds >= 1), values * (kinds >= 2)], axis=1)

    parts, _ = draw_ball(divide, side)
    whole, others = parts[..., :1], parts[..., 1:]
    levels: AnyArray = np.sum((others >= 0.5 * whole) & (whole > 0), axis=-1)
    return levels


class Radius:
    """The logarithmic scale of a polar plot of lobes: maps values of a BRDF to radii, 0 to 1.

    `curves` are the values (n,) of all lobes in the plot. The radius 0 is a power of ten below the
    values, at most `LARGEST_RANGE` decades below the largest, whose radius is nearly 1.
    """

    def __init__(self, curves: list[AnyArray]) -> None:
        positive = [values[values > 0] for values in curves]
        positive = [values for values in positive if values.size] or [np.ones(1)]
        highest = np.log10(max(values.max() for values in positive))
        lowest = np.log10(min(np.percentile(values, 2) for values in positive))
        lowest -= MARGIN * (highest - lowest)
        self.lowest = math.floor(min(max(lowest, highest - LARGEST_RANGE), highest - 0.5))
        self.decades = 1.03 * (highest - self.lowest)

    def __call__(self, values: ArrayLike) -> Any:
        floor = 10.0**self.lowest  # raises low values, while NaN, an unknown value, stays NaN
        return (np.log10(np.maximum(values, floor)) - self.lowest) / self.decades

    def ticks(self) -> AnyArray:
        """Return the values to label: powers of ten, so few that their labels do not overlap.

        If the scale has fewer than two decades, 3 times these powers, or 2 and 5 times, are added.
        """
        step = math.ceil(self.decades / 4.5)
        powers = 10.0 ** np.arange(self.lowest, self.lowest + self.decades, step)
        between = (1, 2, 5) if self.decades < 1.2 else (1, 3) if self.decades < 2 else (1,)
        ticks = np.outer(powers, between).ravel()
        return ticks[np.log10(ticks) - self.lowest < self.decades]


THETA_I = (30, 60)  # angles of incidence [degrees] of the plotted lobes
# Two of Okabe and Ito's colours, which are visible on white and on black
COLOURS = ("#d55e00", "#3d94d1")
DASHES = "", ' stroke-dasharray="5 2"', ' stroke-dasharray="1 2"'  # measured, inferred, guessed
RADIUS, BORDER = 100, 14  # radius of the half disc, and width of the border around it [pixels]
STEP = 1.5  # angle between neighbouring points of a line [degrees]


def make_lobe_picture(name: str, brdf: Brdf, evidence: Evidence | None = None) -> Picture:
    """Return a polar plot of a BRDF's lobes in the plane of incidence, on a logarithmic scale."""
    angles = " and ".join(f"{theta}°" for theta in THETA_I)
    description = f"lobes of {name}, lit at {angles} from the left"
    if evidence:
        description += "; dashed: inferred from measurements, dotted: guessed"
    draw = partial(_draw_lobes_svg, brdf, evidence, description)
    return Picture(draw, description, 2 * (RADIUS + BORDER))


def _draw_lobes_svg(brdf: Brdf, evidence: Evidence | None, description: str) -> str:
    """Draw the lobes of a BRDF, and return them as the text of an SVG with this `description`."""
    theta_o = np.arange(-90 + STEP / 2, 90, STEP)
    curves = [_compute_lobe(brdf, theta_i, theta_o) for theta_i in THETA_I]
    radius = Radius(curves)
    parts = [_draw_half_disc(radius)]
    for theta_i, values, colour in zip(THETA_I, curves, COLOURS, strict=True):
        parts.append(_draw_arrow(theta_i, colour))
        kinds = np.zeros(len(theta_o), int)
        if evidence:
            kinds = evidence(*_make_views(theta_i, theta_o))
        for kind, run in split_runs(kinds):
            parts.append(_draw_curve(theta_o[run], radius(values[run]), colour, DASHES[kind]))
    width, height = 2 * (RADIUS + BORDER), RADIUS + 2 * BORDER
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" '
        f'viewBox="{-RADIUS - BORDER} {-RADIUS - BORDER} {width} {height}" role="img" '
        f'aria-label="{escape(description)}" font-size="9" fill="none" text-anchor="middle">'
        f"<title>{escape(description)}</title>{''.join(parts)}</svg>"
    )


def _compute_lobe(brdf: Brdf, theta_i: float, theta_o: AnyArray) -> AnyArray:
    """Compute the BRDF's luminances (n,) in the plane of incidence, towards `theta_o` (n,).

    The angles are in degrees. The luminance is 0 where the BRDF is unknown.
    """
    values = luminance(np.asarray(brdf(*_make_views(theta_i, theta_o))))
    return np.where(np.isfinite(values), np.maximum(values, 0), 0.0)


def _make_views(theta_i: float, theta_o: AnyArray) -> tuple[AnyArray, AnyArray]:
    """Return the directions wi, wo (n, 3) of views at `theta_o` (n,), for light from the left."""
    wi = np.broadcast_to(from_angles(np.radians(theta_i), np.pi), (len(theta_o), 3))
    return wi, from_angles(np.radians(theta_o), 0.0)


def split_runs(kinds: AnyArray) -> list[tuple[int, slice]]:
    """Return the runs of equal numbers in `kinds` (n,), each with the first point of the next one.

    >>> split_runs(np.array([0, 0, 2]))
    [(0, slice(0, 3, None)), (2, slice(2, 3, None))]
    """
    ends = [*(np.flatnonzero(np.diff(kinds)) + 1).tolist(), len(kinds)]
    starts = [0, *ends[:-1]]
    return [
        (int(kinds[a]), slice(a, min(b + 1, len(kinds)))) for a, b in zip(starts, ends, strict=True)
    ]


def _draw_half_disc(radius: Radius) -> str:
    """Draw the base line of the plot, and labelled half circles at the ticks of the scale."""
    parts = [f'<path d="M{-RADIUS} 0H{RADIUS}" stroke="currentColor" stroke-opacity=".4"/>']
    for tick in radius.ticks():
        r = RADIUS * float(radius(tick))
        parts.append(
            f'<path d="M{-r:.1f} 0A{r:.1f} {r:.1f} 0 0 1 {r:.1f} 0" stroke="currentColor" '
            f'stroke-opacity=".18"/><text x="{r:.1f}" y="10" fill="currentColor" '
            f'fill-opacity=".65">{tick:g}</text>'
        )
    return "".join(parts)


def _draw_curve(theta_o: AnyArray, radii: AnyArray, colour: str, dashes: str) -> str:
    """Draw a line through points with the `radii` (n,), relative to the rim, at `theta_o` (n,)."""
    points = " ".join(
        f"{x:.1f},{y:.1f}" for x, y in zip(*_polar_to_pixels(theta_o, radii), strict=True)
    )
    return f'<polyline points="{points}" stroke="{colour}" stroke-width="1.6"{dashes}/>'


def _draw_arrow(theta_i: float, colour: str) -> str:
    """Draw an arrow at the rim for the light's direction, labelled with its angle [degrees]."""
    (x, y), (to_x, to_y) = (_polar_to_pixels(-theta_i, r) for r in (1.0, 0.86))
    label_x, label_y = _polar_to_pixels(-theta_i, 1.09)
    return (
        f'<path d="M{x:.1f} {y:.1f}L{to_x:.1f} {to_y:.1f}" stroke="{colour}" stroke-width="2.5"/>'
        f'<text x="{label_x:.1f}" y="{label_y + 3:.1f}" fill="{colour}">{theta_i}°</text>'
    )


def _polar_to_pixels(theta: Any, radius: Any) -> tuple[Any, Any]:
    """Convert an angle [degrees] and a radius, 1 at the rim, to pixels x and y (downwards)."""
    theta = np.radians(theta)
    return RADIUS * radius * np.sin(theta), -RADIUS * radius * np.cos(theta)
