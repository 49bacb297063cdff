"""Measures the edge of the hard shadow of a light of radius 0, section 4.1 and Figure 1.1."""

import numpy as np
from brdfkit.theses.balint2019 import scenes
from brdfkit.theses.balint2019.measuring import read_shares
from brdfkit.theses.balint2019.view import View, make_ground_cones

from brdfkit.core.jit.threads import in_turn
from brdfkit.distance_fields.shadows.marches import compute_hard_shadow, compute_linear_shadow
from brdfkit.theses.claims import Claim, to_verdict
from brdfkit.theses.drawing import make_figure
from brdfkit.theses.page import Picture, Section

SECONDS = 3
SIZE, HALF, EPSILON, RADIUS = 256, 2.5, 1 / 30, 0.5
PARTLY = 0.02  # shares from this to 1 minus this are neither lit nor dark
TEXT = f"""The simple scene. The width of the edge is measured on its ground, seen from above
through all objects with {SIZE} × {SIZE} pixels, and with empty balls that are as wide as a pixel,
as those of the thesis: the area of the pixels that are neither lit nor dark, over the length of the
edge, the sum of |∇ share|. So it is the mean width."""


@in_turn
def check_claims(sources, report):
    """Check the claims on the width of a hard shadow's edge; return their section of the page."""
    scene = scenes.simple()
    cone = make_ground_cones(SIZE, HALF, scene.light, 0.0, HALF / SIZE)
    share = read_shares(compute_hard_shadow(scene.field, cone, EPSILON)).reshape(SIZE, SIZE)
    report(1, 2)
    wide = measure_edge_width(share)
    claim = Claim(
        "With a light of radius 0 the shadow is hard, and its edge blurred over about a pixel.",
        "4.1, Figure 1.1",
        "1 pixel",
        f"{wide:.2f} pixels in the mean",
        to_verdict(0.5 < wide < 1.5),
        "Confirmed from 0.5 to 1.5 pixels. The ball about the point, which is as wide as the "
        "pixel, makes the width.",
    )
    caption = "Without shadows, with a hard one, and with those of lights of two radii."
    return Section(
        "Hard shadows", TEXT, [claim], [], [Picture("hard_edges", draw_radii(), caption)]
    )


def measure_edge_width(share):
    """Return the width of the edge between light and shadow [pixels] in an image."""
    partly = (share > PARTLY) & (share < 1 - PARTLY)
    slope = np.hypot(np.diff(share, axis=0)[:, 1:], np.diff(share, axis=1)[1:])
    return partly.sum() / slope.sum()


def draw_radii():
    """Draw a scene without shadows, with a hard one, and with soft ones."""
    view = View(scenes.simple(), SIZE)
    field = view.scene.field
    shown = {
        "no shadow": 1.0,
        "radius 0": read_shares(compute_hard_shadow(field, view.make_cones(0.0), EPSILON)),
        f"radius {RADIUS:g}": read_shares(
            compute_linear_shadow(field, view.make_cones(RADIUS), EPSILON)
        ),
        f"radius {2 * RADIUS:g}": read_shares(
            compute_linear_shadow(field, view.make_cones(2 * RADIUS), EPSILON)
        ),
    }
    drawn = make_figure(9, 2.5)
    for axes, (title, visible) in zip(drawn.subplots(1, len(shown)), shown.items(), strict=True):
        axes.imshow(view.shade(visible), cmap="gray", vmin=0, vmax=1)
        axes.set_title(title, size=9)
        axes.set_axis_off()
    return drawn
