"""Small pictures of any BRDF, which notebooks show beside its figures: a ball, and its lobes."""

import io
import math
from functools import partial
from html import escape

import numpy as np

from brdfkit.core.colours import luminance, to_srgb
from brdfkit.core.documents import Picture
from brdfkit.core.geometry.directions import from_angles
from brdfkit.images.ball.ball import draw_ball

SIDE = 92  # pixels
MOST_DECADES = 5
# The darkest is this share of the range from the centre: nearer, both sides of a line meet there,
# and a dark lobe is a wedge
MARGIN = 0.2


def make_thumbnails(name, brdf):
    """The `Picture`s of a BRDF (wi, wo) → (n, 1 or 3), the material called `name`."""
    return make_ball_picture(name, brdf), make_lobe_picture(name, brdf)


def make_ball_picture(name, brdf):
    """The `Picture` of a ball of a BRDF (wi, wo) → (n, 1 or 3), the material called `name`."""
    return Picture(partial(_draw_ball_png, brdf), f"a ball of {name} under two softboxes", SIDE)


def _draw_ball_png(brdf):
    """The PNG of the ball."""
    from PIL import Image

    linear, cover = draw_ball(brdf, SIDE)
    rgb = np.broadcast_to(to_srgb(linear), (SIDE, SIDE, 3))
    pixels = np.dstack([rgb, cover]) * 255 + 0.5
    stream = io.BytesIO()
    Image.fromarray(pixels.astype(np.uint8)).save(stream, "PNG")
    return stream.getvalue()


class Radius:
    """Maps BRDF values to radii by their logarithm.

    A power of ten below them is 0, the largest nearly 1.
    `curves`: the values (n,) of each lobe that is drawn. At most `MOST_DECADES` are shown.
    """

    def __init__(self, curves):
        shown = [values[values > 0] for values in curves]
        shown = [values for values in shown if values.size] or [np.ones(1)]
        highest = np.log10(max(values.max() for values in shown))
        lowest = np.log10(min(np.percentile(values, 2) for values in shown))
        lowest -= MARGIN * (highest - lowest)
        self.lowest = math.floor(min(max(lowest, highest - MOST_DECADES), highest - 0.5))
        self.decades = 1.03 * (highest - self.lowest)

    def __call__(self, values):
        floor = 10.0**self.lowest  # NaN, where nothing was measured, stays NaN
        return (np.log10(np.maximum(values, floor)) - self.lowest) / self.decades

    def ticks(self):
        """Values to label from the centre to the rim: powers of ten, so few that no labels touch.

        Where fewer than two decades are shown, 2 and 5 or 3 times these powers are labelled, too.
        """
        step = math.ceil(self.decades / 4.5)
        powers = 10.0 ** np.arange(self.lowest, self.lowest + self.decades, step)
        between = (1, 2, 5) if self.decades < 1.2 else (1, 3) if self.decades < 2 else (1,)
        ticks = np.outer(powers, between).ravel()
        return ticks[np.log10(ticks) - self.lowest < self.decades]


THETA_I = (30, 60)  # degrees
# Two of Okabe and Ito's colours that are seen on white and on black
COLOURS = ("#d55e00", "#3d94d1")
SIZE, ROOM = 100, 14  # of the half disc's radius and of what is around it, in pixels
STEP = 1.5  # degrees between points


def make_lobe_picture(name, brdf):
    """The `Picture` of the lobes of a BRDF (wi, wo) → (n, 1 or 3), the material called `name`."""
    angles = " and ".join(f"{theta}°" for theta in THETA_I)
    says = f"lobes of {name}, lit at {angles} from the left"
    return Picture(partial(_draw_lobes_svg, brdf, says), says, 2 * (SIZE + ROOM))


def _draw_lobes_svg(brdf, says):
    """The SVG of the lobes."""
    theta_o = np.arange(-90 + STEP / 2, 90, STEP)
    curves = [_compute_lobe(brdf, theta_i, theta_o) for theta_i in THETA_I]
    radius = Radius(curves)
    parts = [_draw_half_disc(radius)]
    for theta_i, values, colour in zip(THETA_I, curves, COLOURS, strict=True):
        parts += [_draw_arrow(theta_i, colour), _draw_curve(theta_o, radius(values), colour)]
    width, height = 2 * (SIZE + ROOM), SIZE + 2 * ROOM
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" '
        f'viewBox="{-SIZE - ROOM} {-SIZE - ROOM} {width} {height}" role="img" '
        f'aria-label="{escape(says)}" font-size="9" fill="none" text-anchor="middle">'
        f"<title>{escape(says)}</title>{''.join(parts)}</svg>"
    )


def _compute_lobe(brdf, theta_i, theta_o):
    """The luminances (n,) at incidence `theta_i`, to `theta_o` (n,) [degrees]; 0 where unknown."""
    wi = np.broadcast_to(from_angles(np.radians(theta_i), np.pi), (len(theta_o), 3))
    values = luminance(np.asarray(brdf(wi, from_angles(np.radians(theta_o), 0.0))))
    return np.where(np.isfinite(values), np.maximum(values, 0), 0.0)


def _draw_half_disc(radius):
    """The rim, and a half circle with its value at powers of ten."""
    parts = [f'<path d="M{-SIZE} 0H{SIZE}" stroke="currentColor" stroke-opacity=".4"/>']
    for tick in radius.ticks():
        r = SIZE * float(radius(tick))
        parts.append(
            f'<path d="M{-r:.1f} 0A{r:.1f} {r:.1f} 0 0 1 {r:.1f} 0" stroke="currentColor" '
            f'stroke-opacity=".18"/><text x="{r:.1f}" y="10" fill="currentColor" '
            f'fill-opacity=".65">{tick:g}</text>'
        )
    return "".join(parts)


def _draw_curve(theta_o, radii, colour):
    points = " ".join(f"{x:.1f},{y:.1f}" for x, y in zip(*_to_pixels(theta_o, radii), strict=True))
    return f'<polyline points="{points}" stroke="{colour}" stroke-width="1.6"/>'


def _draw_arrow(theta_i, colour):
    """The light's direction, from the rim, and its angle."""
    (x, y), (to_x, to_y) = (_to_pixels(-theta_i, r) for r in (1.0, 0.86))
    label_x, label_y = _to_pixels(-theta_i, 1.09)
    return (
        f'<path d="M{x:.1f} {y:.1f}L{to_x:.1f} {to_y:.1f}" stroke="{colour}" stroke-width="2.5"/>'
        f'<text x="{label_x:.1f}" y="{label_y + 3:.1f}" fill="{colour}">{theta_i}°</text>'
    )


def _to_pixels(theta, radius):
    """The place of a radius, a share of the disc's, at an angle to the normal [degrees]; y is
    downwards."""
    return SIZE * radius * np.sin(np.radians(theta)), -SIZE * radius * np.cos(np.radians(theta))
