"""Figures 6.17 to 6.21: where one straight edge is not what is in the way of the light."""

from functools import reduce
from math import pi

import numpy as np
from brdfkit.theses.balint2019.measuring import rms, shares
from brdfkit.theses.balint2019.view import ground

from brdfkit.core.jit.threads import in_turn
from brdfkit.distance_fields import box, plane
from brdfkit.distance_fields.shadows.marches import compute_linear_shadow
from brdfkit.distance_fields.shadows.monte_carlo import compute_monte_carlo_shadow
from brdfkit.distance_fields.shadows.split import compute_split_shadow
from brdfkit.theses.claims import Claim, verdict
from brdfkit.theses.drawing import figure
from brdfkit.theses.page import Picture, Section, Table

SECONDS = 10
SIZE, HALF, RAYS, EPSILON = 128, 2.5, 1024, 1 / 30
LIGHT, RADIUS, BALL = (0.0, 0.0, 8.0), 1.0, 0.02
SHADE, CLEAR = 0.02, 0.05  # a share that counts as shadow, and an error that counts
SHOWN = 0.5  # the range of the differences
TEXT = f"""The ground below an object, seen from above through it, under a light of radius
{RADIUS:g} at {LIGHT[2]:g}; ε = 1/30, the truth by {RAYS:,} rays. *Leak*: the share of the light
that is seen at most where hardly any arrives. `split`, seven narrower cones, is brdfkit's answer to
what the thesis leaves for later."""


def pointed():
    """A plate whose four corners stand out."""
    return box((2, 2, 1.4)).rotate(pi / 4).at(0, 0, 3)


def several():
    """Two walls one above the other, which leave no gap, and block what neither does alone."""
    return box((4, 6, 0.8)).at(-2, 0, 2) | box((4, 6, 1.4)).at(2, 0, 4)


def bar():
    """A bar with right-angled edges to both sides."""
    return box((1.5, 6, 1.5)).rotate(pi / 4, (0, 1, 0)).at(0, 0, 3)


def thin():
    """A plate that is thinner than the cone is wide."""
    return box((3, 3, 0.1)).at(0, 0, 3)


def estimated():
    """The pointed plate as the half-spaces of its faces: outside, its distance is an estimate."""
    faces = [
        plane([sign * (i == axis) for i in range(3)]).translate(
            [sign * half * (i == axis) for i in range(3)]
        )
        for axis, half in enumerate((1, 1, 0.7))
        for sign in (-1, 1)
    ]
    return reduce(lambda a, b: a & b, faces).rotate(pi / 4).at(0, 0, 3)


SOLIDS = {
    "pointed": (pointed, "Figures 6.17, 6.18"),
    "several": (several, "Figure 6.19"),
    "bar": (bar, "Figure 6.20"),
    "thin": (thin, "Figure 6.21"),
    "estimated": (estimated, "6.5"),
}


@in_turn
def run(sources, report):
    """The shadows, and the claims on them."""
    found = {}
    for done, (name, (solid, _)) in enumerate(SOLIDS.items()):
        found[name] = Shadows(solid())
        report(done + 1, len(SOLIDS))
    claims = [
        dark_claim(found["pointed"]),
        leak_claim("Several objects leak light between them.", found, "several"),
        leak_claim("Edges spread their penumbra into the shadow.", found, "bar"),
        leak_claim("Objects that are thinner than the cone leak light.", found, "thin"),
        estimate_claim(found["estimated"], found["pointed"]),
    ]
    rows = [
        (
            name,
            where,
            *(f"{value:.3f}" for m in ("linear", "split") for value in found[name].figures(m)),
        )
        for name, (_, where) in SOLIDS.items()
    ]
    measures = "error", "darkest", "leak"
    heads = "", "where", *(f"{m}: {what}" for m in ("linear", "split") for what in measures)
    caption = "From the left: the truth, `linear`, and the differences of `linear` and of `split`, "
    caption += f"±{SHOWN:g}; red is too dark, blue too bright."
    picture = Picture("model_errors", draw(found), caption)
    return Section("Errors of the model", TEXT, claims, [Table(heads, rows)], [picture])


class Shadows:
    """Images of a solid's shadow: the truth, and by two methods."""

    def __init__(self, field):
        cone = ground(SIZE, HALF, LIGHT, RADIUS, BALL)
        calls = {
            "truth": compute_monte_carlo_shadow(field, cone, RAYS, 1e-4),
            "linear": compute_linear_shadow(field, cone, EPSILON),
            "split": compute_split_shadow(field, cone, EPSILON),
        }
        self.images = {name: shares(s).reshape(SIZE, SIZE) for name, s in calls.items()}

    def error(self, method):
        """The image by a method less the truth."""
        return self.images[method] - self.images["truth"]

    def leak(self, method):
        """The most light where hardly any arrives."""
        dark = self.images["truth"] < SHADE
        return float(self.images[method][dark].max(initial=0))

    def figures(self, method):
        """The error, how far too dark it is at most, and the leak."""
        error = self.error(method)
        return rms(error), -float(error.min()), self.leak(method)


def dark_claim(shadows):
    """Corners."""
    error, kept = (shadows.error(m) for m in ("linear", "split"))
    return Claim(
        "Pointed objects cast too dark a shadow.",
        SOLIDS["pointed"][1],
        "a picture",
        f"up to {-error.min():.2f} too dark at corners, {error.max():.2f} too bright anywhere; by "
        f"`split` {-kept.min():.2f}",
        verdict(-error.min() > CLEAR and -error.min() > 2 * error.max()),
        "Confirmed where it is above 0.05, and twice what it is too bright.",
    )


def leak_claim(says, found, name):
    """Light where none arrives."""
    shadows = found[name]
    return Claim(
        says,
        SOLIDS[name][1],
        "a picture",
        f"{shadows.leak('linear'):.2f} of the light is seen where none arrives; by `split` "
        f"{shadows.leak('split'):.2f}",
        verdict(shadows.leak("linear") > CLEAR),
        "Confirmed above 0.05.",
    )


def estimate_claim(estimated, exact):
    """The same solid by two distances."""
    apart = estimated.images["linear"] - exact.images["linear"]
    errors = [rms(s.error("linear")) for s in (exact, estimated)]
    return Claim(
        "Where a distance is an estimate, shadows differ.",
        SOLIDS["estimated"][1],
        "no figure",
        f"up to {np.abs(apart).max():.2f}, {-apart.min():.2f} darker; errors {errors[0]:.3f} and "
        f"{errors[1]:.3f}",
        verdict(np.abs(apart).max() > CLEAR),
        "The same plate as a box, and as an intersection of half-spaces; confirmed above 0.05.",
    )


def draw(found):
    """A row for each solid: the truth, `linear`, and two differences."""
    drawn = figure(7.6, 1.9 * len(found))
    grid = drawn.subplots(len(found), 4, squeeze=False)
    for row, (name, shadows) in zip(grid, found.items(), strict=True):
        for axes, image in zip(row[:2], ("truth", "linear"), strict=True):
            axes.imshow(shadows.images[image], cmap="gray", vmin=0, vmax=1, origin="lower")
            axes.set_title(f"{name}: {image}", size=9)
        for axes, method in zip(row[2:], ("linear", "split"), strict=True):
            error = shadows.error(method)
            axes.imshow(error, cmap="RdBu", vmin=-SHOWN, vmax=SHOWN, origin="lower")
            axes.set_title(f"{method} - truth", size=9)
        for axes in row:
            axes.set_axis_off()
    return drawn
