"""Notes on colours: of lobes that only make sense in their sum, and of a fit at grazing angles."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from brdfkit.core.geometry.directions import cos_theta_h
from brdfkit.core.names import join_words
from brdfkit.materials.measured import Measured
from brdfkit.model import Model
from brdfkit.model.samples import Samples
from brdfkit.model.samples.measures import compute_measure

# A lobe has a pure colour where its least channel is below the share PURE of its largest; two
# colours differ in hue where the cosine between them is below ALIKE
PURE, ALIKE = 0.1, 0.5
# Lobes with a smaller share of the highlight's albedo than this get no note
FAINT = 0.05
# Samples whose cosine of the half angle θ_h is above this form the highlight of the material
HIGHLIGHT = np.cos(np.radians(5))
# The rim: samples within RIM degrees of the most grazing, if these lie at least OBLIQUE degrees
# from the normal. The share of R, G or B may be wrong by OFF. At least SPREAD samples have to share
# the light, because a few bright samples do not determine a colour
RIM, OBLIQUE, OFF, SPREAD = 10.0, 60.0, 0.1, 30


def note_on_lobe_colours(
    samples: Samples, fitted: Model, albedos: NDArray[np.float64]
) -> list[str]:
    """Return the note, if any, on lobes that have pure colours of different hues.

    There is no note where the measured highlight has a pure colour, too. `albedos` (lobes, 3) are
    the albedos of the lobes.
    """
    if albedos.shape[1] != 3 or samples.values.shape[1] != 3:
        return []
    diffuse = np.array([lobe.diffuse for lobe in fitted.lobes()])
    own = np.flatnonzero(~diffuse & (albedos.sum(axis=1) > FAINT * albedos[~diffuse].sum()))
    pure = [k for k in own if albedos[k].min() < PURE * albedos[k].max()]
    names = [
        fitted.weights()[k]
        for k in pure
        if any(_cosine(albedos[k], albedos[other]) < ALIKE for other in pure)
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


def note_on_rim(data: Measured, samples: Samples, fitted: Model) -> list[str]:
    """Return the note, if any, on a fit whose colour differs from the measured one at the rim.

    The rim are the most grazing of the fitted samples.
    """
    if samples.values.shape[1] != 3 or fitted.wavelengths:
        return []
    cosine = np.minimum(samples.wi[:, 2], samples.wo[:, 2])
    largest = np.degrees(np.arccos(np.clip(cosine.min(), 0, 1)))
    if largest < OBLIQUE:
        return []
    rim = samples.at(cosine < np.cos(np.radians(largest - RIM)))
    light = rim.weight * rim.wi[:, 2] * rim.wo[:, 2]
    if data.is_table:  # its cells are small and many in the highlight
        light = light * compute_measure(rim.extents, "solid_angle")
    each = light * np.maximum(rim.values, 0).sum(axis=1)
    if not each.sum() or each.sum() ** 2 < SPREAD * (each**2).sum():
        return []  # dark, or a few bright samples
    ours, theirs = (_shares(light @ values) for values in (fitted.eval(rim.wi, rim.wo), rim.values))
    if np.abs(ours - theirs).max() < OFF:
        return []
    modelled, measured = (" : ".join(f"{100 * s:.0f}" for s in shares) for shares in (ours, theirs))
    return [
        f"its colour at {largest - RIM:.0f}° to {largest:.0f}° is R : G : B = {modelled}, where "
        f"{measured} was measured: try another model, or one lobe more"
    ]


def _shares(colour: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the shares of R, G and B in a colour; negative values count as 0."""
    positive = colour.clip(min=0)
    return positive / (positive.sum() + 1e-300)


def _cosine(one: NDArray[np.float64], other: NDArray[np.float64]) -> float:
    """Return the cosine of the angle between two colours, which is 1 for equal hues."""
    lengths = float(np.linalg.norm(one) * np.linalg.norm(other))
    return float(one @ other) / (lengths + 1e-300)
