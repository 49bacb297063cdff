"""Measures the grain of shadows by few rays, which are alike at all points or each point's own."""

import drjit as dr
import numpy as np
from brdfkit.theses.balint2019.measuring import read_shares
from drjit.llvm import Float

from brdfkit.distance_fields.shadows.monte_carlo import (
    choose_ray,
    compute_monte_carlo_shadow,
    trace_ray,
)
from brdfkit.theses.claims import Claim
from brdfkit.theses.grid import judge_over_grid

FEW = 3  # rays
PARTLY = 0.02  # shares from this to 1 minus this are in the penumbra
CLEAR = 0.01  # the least share of grains in a penumbra that counts
ALIKE, OWN = "alike at all points", "each point's own"


def claim_grain(frames):
    """Claim that few rays are grainy, by frames (radius of the light → `Frame`)."""
    grains = {}
    for radius, frame in frames.items():
        field, cone = frame.view.scene.field, frame.view.make_cones(radius)
        shares = {
            ALIKE: read_shares(compute_monte_carlo_shadow(field, cone, FEW)),
            OWN: draw_shadow(field, cone, FEW),
            "march": frame.shares["linear"],
        }
        for rays, share in shares.items():
            grains[rays, f"{radius:g}"] = measure_grain(frame.view, share, frame.truth)
    cells = {
        (rays, radius): grain > CLEAR and grain > 2 * grains["march", radius]
        for (rays, radius), grain in grains.items()
        if rays != "march"
    }
    radii = [f"{radius:g}" for radius in frames]
    ours, verdict = judge_over_grid(("drawing of rays", "radius"), cells)
    words = (
        f"{' and '.join(f'{100 * grains[rays, r]:.1f}' for r in radii)} % {what}"
        for rays, what in (
            (OWN, "by each point's own rays"),
            (ALIKE, "by rays that are alike"),
            ("march", "by one march"),
        )
    )
    return Claim(
        "Three rays are grainy.",
        "Figure 6.4",
        "a picture",
        f"grains are {', '.join(words)}; {ours}",
        verdict,
        "A grain is a pixel of the penumbra that is brighter or darker than its four neighbours; "
        f"the lights have the radii {' and '.join(radii)}. Confirmed above "
        f"{100 * CLEAR:g} % and twice those of one march. The thesis does not say whether its "
        "Halton points are the same in all pixels. By the same rays, as in the figure below, "
        f"there is no grain: the penumbra has {FEW} steps.",
    )


def measure_grain(view, shares, truth):
    """Return the share of the penumbra's pixels that are above or below all four neighbours."""
    image = view.make_image(shares, 0)
    partly = view.make_image((truth > PARTLY) & (truth < 1 - PARTLY), 0)[1:-1, 1:-1] > 0
    middle, sides = image[1:-1, 1:-1], (image[:-2], image[2:], image[:, :-2], image[:, 2:])
    near = np.stack([side[:, 1:-1] if i < 2 else side[1:-1] for i, side in enumerate(sides)])
    grains = (middle > near.max(axis=0)) | (middle < near.min(axis=0))
    return float(grains[partly].mean()) if partly.any() else 0.0


def draw_shadow(field, cone, rays):
    """Return shares (n,) of the light by rays that are drawn at random for each point."""
    rng, lit, width = np.random.default_rng(0), 0.0, dr.width(cone.d)
    for _ in range(rays):
        r, phi = np.sqrt(rng.random(width)), 2 * np.pi * rng.random(width)
        ray = choose_ray(cone, Float(r * np.cos(phi)), Float(r * np.sin(phi)))
        lit = lit + (np.array(trace_ray(field, cone, *ray, 1e-3)[0]) > 0)
    return lit / rays
