"""Checks light scattered once in a slab against closed forms and another renderer."""

import math

import numpy as np

from brdfkit.core.jit.llvm import use_variant
from brdfkit.core.jit.threads import in_turn
from brdfkit.theses.claims import Claim, to_verdict
from brdfkit.theses.page import Section, Table

SECONDS = 3
SIZE, SPP = 64, 256
SLABS = {  # extinction σ, albedo α, g, depth D, d_z of the sun: the radiance by volpath
    (1, 0.8, 0.6, 2, -1): 0.172089,
    (1, 0.8, 0.6, 2, 1): 0.004868,
    (2, 0.5, -0.3, 1, 0.5): 0.017210,
    (2, 0.5, -0.3, 1, -0.5): 0.002586,
    (0.5, 1, 0, 4, 0.7071): 0.032800,
}
TEXT = f"""An even slab of depth D in sunlight of irradiance 1, seen straight on; {SIZE * SIZE:,}
pixels of {SPP} samples. The integral over the depth is known: for d_z > 0, the cosine of the sun's
rays, L = α p(-d_z) (1 - exp(-σ D (1 + 1/d_z))) / (1 + 1/d_z). The thesis prints no radiance; it
states the steps, and leaves albedo, lights and the ray to the light open."""


@in_turn
def check_claims(sources, report):
    """Check the claims on light scattered once in slabs; return their section of the page."""
    use_variant()
    rows, z = [], []
    for done, (slab, apart) in enumerate(SLABS.items()):
        known = compute_closed_form(*slab)
        mean, error = render_radiance(*slab)
        z.append((mean - known) / error)
        ours = f"{mean:.6f} ({z[-1]:+.1f})"
        rows.append((*(f"{v:g}" for v in slab), f"{known:.6f}", ours, f"{apart:.6f}"))
        report(done + 1, len(SLABS))
    claim = Claim(
        "A mean over random collisions converges to the right picture.",
        "ch. 6, 8",
        f"{len(SLABS)} slabs in closed form",
        f"{min(z):+.1f} to {max(z):+.1f} standard errors",
        to_verdict(max(map(abs, z)) < 3.3),
        "Collisions by Woodcock tracking, ratio tracking to the sun. Confirmed below 3.3.",
    )
    heads = "σ", "α", "g", "D", "d_z", "closed form", "here", "Mitsuba's volpath, apart"
    caption = "Radiance, and how many standard errors ours is off."
    return Section("Single scattering", TEXT, [claim], [Table(heads, rows, caption)])


def compute_closed_form(sigma, albedo, g, depth, cosine):
    """Return the radiance of light scattered once in a slab, in closed form.

    `cosine` is that of the sun's rays to z.
    """
    phase = (1 - g * g) / (4 * math.pi * (1 + g * g + 2 * g * cosine) ** 1.5)
    if cosine > 0:
        there_and_back = 1 + 1 / cosine
        return albedo * phase * -math.expm1(-sigma * depth * there_and_back) / there_and_back
    rate = sigma * (1 - 1 / -cosine)
    length = -math.expm1(-rate * depth) / rate if rate else depth
    return sigma * albedo * phase * math.exp(-sigma * depth / -cosine) * length


def render_radiance(sigma, albedo, g, depth, cosine):
    """Return the radiance of a slab by `single_scattering`, and its standard error."""
    import mitsuba as mi

    wide = mi.ScalarTransform4f().scale([1000, 1000, depth]).translate([-0.5, -0.5, 0])
    values = np.full((1, 1, 1, 1), sigma, np.float32)
    grid = {"type": "gridvolume", "grid": mi.VolumeGrid(values), "raw": True, "to_world": wide}
    phase = {"type": "hg", "g": g}
    smoke = {"type": "single_scattering", "extinction": grid, "albedo": albedo, "phase": phase}
    camera = mi.ScalarTransform4f().look_at([0, 0, -1], [0, 0, 0], [0, 1, 0]).scale(1e-3)
    film = {"type": "hdrfilm", "width": SIZE, "height": SIZE, "rfilter": {"type": "box"}}
    film["pixel_format"] = "luminance"
    direction = [math.sqrt(1 - cosine**2), 0, cosine]
    scene = {
        "type": "scene",
        "integrator": smoke,
        "sensor": {"type": "orthographic", "to_world": camera, "film": film},
        "sun": {"type": "directional", "direction": direction, "irradiance": 1.0},
    }
    found = np.array(mi.render(mi.load_dict(scene, parallel=False), spp=SPP), float)
    return found.mean(), found.std() / math.sqrt(found.size)
