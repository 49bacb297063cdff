"""Reproduces Figure 9.6, the reciprocity of the polynomial and other models."""

import numpy as np
from brdfkit.theses.kurt2007.curet import PLAIN
from brdfkit.theses.kurt2007.neural import decode_network
from brdfkit.theses.kurt2007.printed import SEVEN

from brdfkit.core.geometry.directions import from_angles
from brdfkit.fitting.fit import fit
from brdfkit.materials.measured import Measured
from brdfkit.model import labels
from brdfkit.theses.claims import Claim, to_verdict
from brdfkit.theses.page import Section

SECONDS = 3
PAIRS = 10_000
MATERIAL = "orange-paint"
CELLS = 30, 30, 60
TEXT = f"""On {PAIRS:,} random pairs of directions. The polynomial of degree 5 is fitted to the
neural reconstruction of {MATERIAL}."""


def check_claims(sources, report):
    """Check the claims on the reciprocity of BRDF models; return their section of the page."""
    with np.load(sources.find_file("nbrdf_derived/merl_nbrdf.npz")) as networks:
        table = decode_network(networks[MATERIAL], CELLS)
    data = Measured.from_table(table.values, name=MATERIAL)
    found = fit(data, "pca_polynomial:degree=5", loss=PLAIN, robust="bisquare")
    report(1, 2)
    others = ("phong", *SEVEN.values(), "torrance_sparrow", "koenderink:order=8")
    worst = max(_measure_asymmetry(labels.model(name)()) for name in others)
    difference = _measure_asymmetry(found.model)
    claims = [
        Claim(
            "With light and view exchanged the polynomial gives the same picture.",
            "Figure 9.6",
            "identical",
            f"largest relative difference {difference:.1g}",
            to_verdict(difference <= 1e-12),
            "By construction: it is made of products of the components of both directions.",
            arithmetic=True,
        ),
        Claim(
            "All models of chapter 3 are reciprocal.",
            "chapter 3",
            "reciprocal",
            f"largest relative difference {worst:.1g}",
            to_verdict(worst <= 1e-12),
            "In all printed forms, at our defaults: seen in the formulas.",
            arithmetic=True,
        ),
    ]
    return Section("Figure 9.6: reciprocity", TEXT, claims)


def _measure_asymmetry(model):
    """Return the largest difference of a BRDF when its directions are exchanged, relative to it."""
    rng = np.random.default_rng(9)
    wi, wo = from_angles(np.arccos(rng.random((2, PAIRS))), 2 * np.pi * rng.random((2, PAIRS)))
    forth, back = model.eval(wi, wo), model.eval(wo, wi)
    return float((np.abs(forth - back) / np.maximum(np.abs(forth), 1e-300)).max())
