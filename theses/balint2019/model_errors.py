"""Measures errors where objects in the light's way are not one straight edge, as the model assumes.

The thesis shows such objects in Figures 6.17 to 6.21.
"""

from functools import reduce
from math import pi

import numpy as np
from brdfkit.theses.balint2019.measuring import compute_rms, read_shares
from brdfkit.theses.balint2019.view import make_ground_cones

from brdfkit.core.jit.threads import in_turn
from brdfkit.distance_fields import box, plane
from brdfkit.distance_fields.shadows.marches import compute_linear_shadow
from brdfkit.distance_fields.shadows.monte_carlo import compute_monte_carlo_shadow
from brdfkit.distance_fields.shadows.split import compute_split_shadow
from brdfkit.theses.claims import Claim, to_verdict
from brdfkit.theses.drawing import make_figure
from brdfkit.theses.page import Picture, Section, Table

SECONDS = 10
SIZE, HALF, RAYS, EPSILON = 128, 2.5, 1024, 1 / 30
LIGHT, RADIUS, BALL = (0.0, 0.0, 8.0), 1.0, 0.02
SHADE, CLEAR = 0.02, 0.05  # the largest share that counts as dark, the least error that counts
SHOWN = 0.5  # the largest difference that the figure shows
TEXT = f"""The ground below an object, seen from above through it, under a light of radius
{RADIUS:g} at {LIGHT[2]:g}; ε = 1/30, the truth by {RAYS:,} rays. *Leak*: the share of the light
that is seen at most where hardly any arrives. `split`, seven narrower cones, is brdfkit's answer to
what the thesis leaves for later."""


def make_pointed_plate():
    """Return a plate whose four corners stand out."""
    return box((2, 2, 1.4)).rotate(pi / 4).at(0, 0, 3)


def make_two_walls():
    """Return two walls, one above the other, which together leave no gap.

    Each of them alone lets light pass.
    """
    return box((4, 6, 0.8)).at(-2, 0, 2) | box((4, 6, 1.4)).at(2, 0, 4)


def make_bar():
    """Return a bar with right-angled edges to both sides."""
    return box((1.5, 6, 1.5)).rotate(pi / 4, (0, 1, 0)).at(0, 0, 3)


def make_thin_plate():
    """Return a plate that is thinner than the cone is wide."""
    return box((3, 3, 0.1)).at(0, 0, 3)


def make_estimated_plate():
    """Return the pointed plate as the half-spaces of its faces.

    Outside of the plate its distance is an estimate.
    """
    faces = [
        plane([sign * (i == axis) for i in range(3)]).translate(
            [sign * half * (i == axis) for i in range(3)]
        )
        for axis, half in enumerate((1, 1, 0.7))
        for sign in (-1, 1)
    ]
    return reduce(lambda a, b: a & b, faces).rotate(pi / 4).at(0, 0, 3)


SOLIDS = {
    "pointed": (make_pointed_plate, "Figures 6.17, 6.18"),
    "several": (make_two_walls, "Figure 6.19"),
    "bar": (make_bar, "Figure 6.20"),
    "thin": (make_thin_plate, "Figure 6.21"),
    "estimated": (make_estimated_plate, "6.5"),
}


@in_turn
def check_claims(sources, report):
    """Check the claims on shadows of objects without straight edges; return their section."""
    found = {}
    for done, (name, (solid, _)) in enumerate(SOLIDS.items()):
        found[name] = Shadows(solid())
        report(done + 1, len(SOLIDS))
    claims = [
        claim_dark(found["pointed"]),
        claim_leak("Several objects leak light between them.", found, "several"),
        claim_leak("Edges spread their penumbra into the shadow.", found, "bar"),
        claim_leak("Objects that are thinner than the cone leak light.", found, "thin"),
        claim_estimate(found["estimated"], found["pointed"]),
    ]
    rows = [
        (
            name,
            where,
            *(
                f"{value:.3f}"
                for m in ("linear", "split")
                for value in found[name].compute_figures(m)
            ),
        )
        for name, (_, where) in SOLIDS.items()
    ]
    measures = "error", "darkest", "leak"
    heads = "", "where", *(f"{m}: {what}" for m in ("linear", "split") for what in measures)
    caption = "From the left: the truth, `linear`, and the differences of `linear` and of `split`, "
    caption += f"±{SHOWN:g}; red is too dark, blue too bright."
    picture = Picture("model_errors", draw_shadows(found), caption)
    return Section("Errors of the model", TEXT, claims, [Table(heads, rows)], [picture])


class Shadows:
    """Images of a solid's shadow: the truth by many rays, and shadows by two methods."""

    def __init__(self, field):
        cone = make_ground_cones(SIZE, HALF, LIGHT, RADIUS, BALL)
        calls = {
            "truth": compute_monte_carlo_shadow(field, cone, RAYS, 1e-4),
            "linear": compute_linear_shadow(field, cone, EPSILON),
            "split": compute_split_shadow(field, cone, EPSILON),
        }
        self.images = {name: read_shares(s).reshape(SIZE, SIZE) for name, s in calls.items()}

    def compute_error(self, method):
        """Return the image by a method less the truth."""
        return self.images[method] - self.images["truth"]

    def measure_leak(self, method):
        """Return the largest share of the light where hardly any arrives."""
        dark = self.images["truth"] < SHADE
        return float(self.images[method][dark].max(initial=0))

    def compute_figures(self, method):
        """Return the RMS error, how far the image is too dark at most, and the leak."""
        error = self.compute_error(method)
        return compute_rms(error), -float(error.min()), self.measure_leak(method)


def claim_dark(shadows):
    """Claim that pointed objects cast too dark a shadow."""
    error, kept = (shadows.compute_error(m) for m in ("linear", "split"))
    return Claim(
        "Pointed objects cast too dark a shadow.",
        SOLIDS["pointed"][1],
        "a picture",
        f"up to {-error.min():.2f} too dark at corners, {error.max():.2f} too bright anywhere; by "
        f"`split` {-kept.min():.2f}",
        to_verdict(-error.min() > CLEAR and -error.min() > 2 * error.max()),
        "Confirmed where it is above 0.05, and twice what it is too bright.",
    )


def claim_leak(says, found, name):
    """Claim that light leaks where none arrives."""
    shadows = found[name]
    return Claim(
        says,
        SOLIDS[name][1],
        "a picture",
        f"{shadows.measure_leak('linear'):.2f} of the light is seen where none arrives; by `split` "
        f"{shadows.measure_leak('split'):.2f}",
        to_verdict(shadows.measure_leak("linear") > CLEAR),
        "Confirmed above 0.05.",
    )


def claim_estimate(estimated, exact):
    """Claim that shadows of the same solid differ if its distance is an estimate."""
    apart = estimated.images["linear"] - exact.images["linear"]
    errors = [compute_rms(s.compute_error("linear")) for s in (exact, estimated)]
    return Claim(
        "Where a distance is an estimate, shadows differ.",
        SOLIDS["estimated"][1],
        "no figure",
        f"up to {np.abs(apart).max():.2f}, {-apart.min():.2f} darker; errors {errors[0]:.3f} and "
        f"{errors[1]:.3f}",
        to_verdict(np.abs(apart).max() > CLEAR),
        "The same plate as a box, and as an intersection of half-spaces; confirmed above 0.05.",
    )


def draw_shadows(found):
    """Draw a row for each solid: the truth, the march `linear`, and two differences."""
    drawn = make_figure(8.4, 1.9 * len(found))
    grid = drawn.subplots(len(found), 4, squeeze=False)
    for row, (name, shadows) in zip(grid, found.items(), strict=True):
        for axes, image in zip(row[:2], ("truth", "linear"), strict=True):
            axes.imshow(shadows.images[image], cmap="gray", vmin=0, vmax=1, origin="lower")
            axes.set_title(f"{name}: {image}", size=9)
        for axes, method in zip(row[2:], ("linear", "split"), strict=True):
            error = shadows.compute_error(method)
            bars = axes.imshow(error, cmap="RdBu", vmin=-SHOWN, vmax=SHOWN, origin="lower")
            axes.set_title(f"{method} - truth", size=9)
        for axes in row:
            axes.set_axis_off()
        drawn.colorbar(bars, ax=row[-1], shrink=0.8)
    return drawn
