"""Reproduces Figure 9.6, pictures with light and view exchanged, and the reciprocity of models."""

from dataclasses import replace

import numpy as np
from brdfkit.theses.kurt2007.pictures import (
    MEANS,
    draw_picture_grid,
    render_pictures,
    show_differences,
    show_rendering,
)
from brdfkit.theses.kurt2007.printed import SEVEN
from brdfkit.theses.kurt2007.table_9_3 import POLYNOMIAL, fit_models

from brdfkit.core.geometry.directions import from_angles
from brdfkit.model import labels
from brdfkit.theses.claims import Claim, to_verdict
from brdfkit.theses.page import Picture, Section

SECONDS = 6
PAIRS = 10_000
MATERIAL = "orange-paint"
SAME = 1e-4  # largest relative difference of pictures in single precision
TEXT = f"""On {PAIRS:,} random pairs of directions, and as a picture of `render`. The polynomial of
degree 5 is fitted to the neural reconstruction of {MATERIAL}. *Control*: the same polynomial with
its light weighed by the cosine of the view, 2 cos θ_r, which is not reciprocal."""


def check_claims(sources, report):
    """Check the claims on the reciprocity of BRDF models; return their section of the page."""
    model = fit_models(sources, MATERIAL)[POLYNOMIAL]
    lopsided = _change_lobes(model, lambda value: lambda wi, wo: 2 * wo.z * value(wi, wo))
    report(1, 3)
    pairs = {"f(L, V)": (model, _exchange(model)), "control": (lopsided, _exchange(lopsided))}
    rows, apart = [], {}
    for name, (forth, back) in pairs.items():
        pictures = render_pictures({"L and V": forth, "L and V exchanged": back})
        first, second = pictures.pictures.values()
        apart[name] = float(np.abs(second - first).max() / first.max())
        shown, difference = show_rendering(pictures), show_differences(pictures)
        cells = [*shown.items(), ("difference", difference["L and V exchanged"])]
        rows.append((name, cells))
    report(2, 3)
    others = ("phong", *SEVEN.values(), "torrance_sparrow", "koenderink:order=8")
    worst = max(_measure_asymmetry(labels.model(name)()) for name in others)
    difference = _measure_asymmetry(model)
    claims = [
        Claim(
            "With light and view exchanged the polynomial gives the same picture.",
            "Figure 9.6",
            "identical",
            f"pictures differ by {apart['f(L, V)']:.0e} of the brightest value, the control by "
            f"{apart['control']:.2f}; the formula by {difference:.1g}",
            to_verdict(difference <= 1e-12 and apart["f(L, V)"] <= SAME < apart["control"]),
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
    picture = Picture("figure_9_6", draw_picture_grid(rows, 1.5), MEANS)
    return Section("Figure 9.6: reciprocity", TEXT, claims, (), [picture])


def _change_lobes(model, change):
    """Return a copy of a model whose lobes have other values: `change` of the functions of them."""
    own = type(model)

    def list_lobes(self):
        return tuple(replace(lobe, eval=change(lobe.eval)) for lobe in own.lobes(self))

    made = type(f"Changed{own.__name__}", (own,), {"lobes": list_lobes})
    return made(**model.values)


def _exchange(model):
    """Return a copy of a model with the directions of light and view exchanged."""
    return _change_lobes(model, lambda value: lambda wi, wo: value(wo, wi))


def _measure_asymmetry(model):
    """Return the largest difference of a BRDF when its directions are exchanged, relative to it."""
    rng = np.random.default_rng(9)
    wi, wo = from_angles(np.arccos(rng.random((2, PAIRS))), 2 * np.pi * rng.random((2, PAIRS)))
    forth, back = model.eval(wi, wo), model.eval(wo, wi)
    return float((np.abs(forth - back) / np.maximum(np.abs(forth), 1e-300)).max())
