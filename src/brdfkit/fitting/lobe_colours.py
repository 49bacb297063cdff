"""Writes notes on implausible colours of a fit: of single lobes, and at grazing angles.

A lobe is one term of a model, such as its diffuse part or one of its highlights.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from brdfkit.core.geometry.directions import cos_theta_h
from brdfkit.core.names import join_words
from brdfkit.materials.measured import Measured
from brdfkit.model import Model
from brdfkit.model.samples import Samples
from brdfkit.model.samples.cells import copy_columns
from brdfkit.model.samples.measures import compute_measure

# A colour is pure if its smallest channel is below the share PURE of its largest; two colours have
# different hues if the cosine of the angle between their RGB vectors is below ALIKE
PURE, ALIKE = 0.1, 0.5
# Lobes with a smaller share of the highlight's albedo are ignored: their colour is hardly visible
FAINT = 0.05
# Samples whose half vector is within 5° of the normal form the highlight of the material
HIGHLIGHT = np.cos(np.radians(5))
# Colours are compared in the last 10° before the most grazing sample, if this is at least 60° from
# the normal. There the shares of R, G and B in the sum may differ by 0.1
RIM, OBLIQUE, OFF = 10.0, 60.0, 0.1
# Least effective number of samples for a colour: a few bright ones do not determine it
SPREAD = 30


def note_on_lobe_colours(
    samples: Samples, fitted: Model, albedos: NDArray[np.float64]
) -> list[str]:
    """Return a note if the lobes have pure colours of different hues, which the highlight lacks.

    Such lobes only have a meaning in their sum. `albedos` (lobes, 3) are the albedos of the lobes.
    The list is empty if there is nothing to note.
    """
    if albedos.shape[1] != 3 or samples.values.shape[1] != 3:
        return []
    diffuse = np.array([lobe.diffuse for lobe in fitted.lobes()])
    own = np.flatnonzero(~diffuse & (albedos.sum(axis=1) > FAINT * albedos[~diffuse].sum()))
    pure = [k for k in own if albedos[k].min() < PURE * albedos[k].max()]
    names = [
        fitted.weights()[k]
        for k in pure
        if any(_compare_hues(albedos[k], albedos[other]) < ALIKE for other in pure)
    ]
    if not names:
        return []
    cosine = cos_theta_h(samples.wi, samples.wo)
    near = cosine >= min(HIGHLIGHT, np.sort(cosine)[-min(10, len(cosine))])
    highlight = np.maximum(samples.values[near], 0).mean(axis=0)
    if highlight.min() < 2 * PURE * highlight.max():
        return []
    return [
        f"{join_words(names)} have pure colours that the highlight has not: only the sum of these "
        "lobes means something; fit one lobe fewer to read it"
    ]


def note_on_grazing_colour(data: Measured, samples: Samples, fitted: Model) -> list[str]:
    """Return a note if the fit has another colour than the samples at the most grazing angles.

    The list is empty if there is nothing to note.
    """
    if samples.values.shape[1] != 3 or fitted.wavelengths:
        return []
    cosine = np.minimum(samples.wi[:, 2], samples.wo[:, 2])
    largest = np.degrees(np.arccos(np.clip(cosine.min(), 0, 1)))
    if largest < OBLIQUE:
        return []
    rim = np.flatnonzero(cosine < np.cos(np.radians(largest - RIM)))
    wi, wo, values = (copy_columns(w, rim) for w in (samples.wi, samples.wo, samples.values))
    light = samples.weight[rim] * wi[:, 2] * wo[:, 2]
    if data.is_table and samples.extents is not None:
        # Small cells in the highlight must not count as much as large ones
        light = light * compute_measure(samples.extents[rim], "solid_angle")
    each = light * np.maximum(values, 0).sum(axis=1)
    if not each.sum() or each.sum() ** 2 < SPREAD * (each**2).sum():
        return []  # the rim is black, or only a few samples are bright
    ours, theirs = (_normalise_colour(light @ colours) for colours in (fitted.eval(wi, wo), values))
    if np.abs(ours - theirs).max() < OFF:
        return []
    modelled, measured = (" : ".join(f"{100 * s:.0f}" for s in shares) for shares in (ours, theirs))
    return [
        f"its colour at {largest - RIM:.0f}° to {largest:.0f}° is R : G : B = {modelled}, where "
        f"{measured} was measured: try another model, or one lobe more"
    ]


def _normalise_colour(colour: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the shares of R, G and B in the sum of a colour; negative values count as 0."""
    positive = colour.clip(min=0)
    return positive / (positive.sum() + 1e-300)


def _compare_hues(one: NDArray[np.float64], other: NDArray[np.float64]) -> float:
    """Return the cosine of the angle between two RGB colours; it is 1 for equal hues."""
    lengths = float(np.linalg.norm(one) * np.linalg.norm(other))
    return float(one @ other) / (lengths + 1e-300)
