"""Checks phase functions of chapter 4: their integrals, mean cosines and values."""

import numpy as np
from brdfkit.theses.lesar2018.phases import PLUGINS, compute_moments, make_phase_function

from brdfkit.checks import directions
from brdfkit.core.jit.llvm import use_variant
from brdfkit.core.jit.threads import in_turn
from brdfkit.theses.claims import Claim, to_verdict
from brdfkit.theses.drawing import COLOURS, make_figure, style_axes
from brdfkit.theses.page import Picture, Section, Table
from brdfkit.volumes.made import make_volume

SECONDS = 2
COSINES = (-1, -0.5, 0, 0.5, 1)
APART = {  # phase functions at COSINES [sr⁻¹], by an independent program
    "Henyey-Greenstein 0.6": (0.012434, 0.018560, 0.032112, 0.076869, 0.795775),
    "Henyey-Greenstein -0.3": (0.211124, 0.103131, 0.063634, 0.044189, 0.032961),
    "Schlick 0.8112": (0.008295, 0.013773, 0.027212, 0.077020, 0.763404),
    "Schlick 0.45015": (0.030173, 0.042279, 0.063452, 0.105664, 0.209874),
    "Rayleigh": (0.119366, 0.074604, 0.059683, 0.074604, 0.119366),
    "Mie hazy": (0.039789, 0.039794, 0.041188, 0.075639, 0.397887),
    "Mie murky": (0.039789, 0.039789, 0.039789, 0.039921, 1.352817),
}
DIGIT = 0.65e-6  # half of the last digit of these values, and rounding in single precision
ALBEDO = 0.6  # of a BSDF that is used as a phase function
TEXT = """p(μ) of the plugins of Mitsuba and of brdfkit, in single precision; μ is the cosine of the
angle by which light is deflected, 1 is straight on. Integrals by quadrature with 200 points. The
thesis writes each as a function of two directions, and does not say whether both point along the
light."""


@in_turn
def check_claims(sources, report):
    """Check the claims on integrals and values of phase functions, and return their section."""
    use_variant()
    phases = {name: make_phase_function(entries) for name, entries in PLUGINS.items()}
    found = {name: compute_moments(p) for name, p in phases.items()}
    values = {name: p(COSINES) for name, p in phases.items()}
    claims = [
        claim_integral(found),
        claim_mean(found),
        claim_value(values),
        claim_bsdf(integrate_bsdf()),
    ]
    rows = [(name, f"{found[name][1]:.5f}", *(f"{v:.6f}" for v in values[name])) for name in phases]
    heads = "", "mean cosine", *(f"p({mu:g})" for mu in COSINES)
    caption = "The names have the mean cosine g of Henyey-Greenstein's, and the k of Schlick's."
    picture = Picture("phase_functions", draw_phases(phases), "Straight on is to the left.")
    return Section("Phase functions", TEXT, claims, [Table(heads, rows, caption)], [picture])


def claim_integral(found):
    """Claim that all phase functions integrate to 1."""
    off = max(abs(integral - 1) for integral, _ in found.values())
    return Claim(
        "Phase functions integrate to 1 over the sphere.",
        "eq. 4.43",
        "1",
        f"off by {off:.0e} at most, of {len(found)}",
        to_verdict(off < 1e-6),
        arithmetic=True,
    )


def claim_mean(found):
    """Claim that g of Henyey-Greenstein's phase function is its mean cosine."""
    off = max(abs(found[f"Henyey-Greenstein {g}"][1] - g) for g in (0.6, -0.3))
    return Claim(
        "g of Henyey-Greenstein's is its mean cosine.",
        "eq. 4.58",
        "g",
        f"off by {off:.0e} at most, of 0.6 and -0.3",
        to_verdict(off < 1e-6),
        arithmetic=True,
    )


def claim_value(values):
    """Claim that values are those of the formulas."""
    apart = [np.abs(values[name] - known) for name, known in APART.items()]
    equal = (np.array(apart) < DIGIT).sum()
    total = len(APART) * len(COSINES)
    return Claim(
        "Values of the phase functions, in the forward convention.",
        "eq. 4.58-4.63",
        f"{total} values, computed apart",
        f"{equal} of {total} equal to half of the last digit",
        to_verdict(equal == total),
        arithmetic=True,
    )


def integrate_bsdf():
    """Return ∫ f |n·ωo| over all directions ωo, for a grey matte BSDF f at a gradient as normal."""
    import mitsuba as mi

    grey = {"type": "diffuse", "reflectance": {"type": "rgb", "value": ALBEDO}}
    density = make_volume("slab", (8, 8, 8)).scene_dict()
    entries = {"type": "bsdf_phase", "bsdf": grey, "density": density}
    phase = mi.load_dict(entries, parallel=False)
    it = mi.MediumInteraction3f()
    it.p, it.wi = mi.Point3f(0), mi.Vector3f(0.48, 0.6, 0.64)
    towards, solid_angle = directions.make_sphere_quadrature()
    value = phase.eval_pdf(mi.PhaseFunctionContext(None), it, towards)[0]
    return float(np.array(value)[0] @ solid_angle)


def claim_bsdf(integral):
    """Claim that a BSDF times a cosine integrates to 1, as a phase function does."""
    return Claim(
        "A BSDF times a cosine is a phase function.",
        "eq. 4.57",
        "eq. 4.43: it integrates to 1",
        f"{integral:.4f}, of a BSDF of albedo {ALBEDO:g}",
        to_verdict(abs(integral - 1) < 1e-3),
        "It integrates to the BSDF's albedo, and the cosine makes it change when light and view "
        "are exchanged. `bsdf_phase` draws by the BSDF, what is lost is the medium's own albedo.",
    )


def draw_phases(phases):
    """Draw all phase functions over the angle."""
    drawn = make_figure(7, 3)
    axes = drawn.subplots()
    degrees = np.linspace(0, 180, 361)
    for (name, p), colour in zip(phases.items(), COLOURS, strict=False):
        axes.semilogy(degrees, p(np.cos(np.radians(degrees))), label=name, color=colour)
    axes.set_xlabel("deflection [degrees]")
    axes.set_xticks(np.arange(0, 181, 45))
    axes.legend(fontsize=7)
    style_axes(axes, "", "p [sr⁻¹]")
    return drawn
