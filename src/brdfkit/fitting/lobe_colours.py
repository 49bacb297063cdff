"""Colours of lobes that only their sum means, and of a rim that is not the material's."""

import numpy as np
from numpy.typing import NDArray

from brdfkit.core.geometry.directions import cos_theta_h
from brdfkit.core.names import join_words
from brdfkit.materials.measured import Measured
from brdfkit.model import Model
from brdfkit.model.samples import Samples
from brdfkit.model.samples.measures import compute_measure

# A lobe is of one hue where its least channel is below this share of its largest, and two hues
# differ where the cosine between them is smaller than the second
PURE, ALIKE = 0.1, 0.5
# Lobes with less than this share of the highlight's light do not matter
FAINT = 0.05
# The highlight of the material: samples with the cosine of theta_h above this
HIGHLIGHT = np.cos(np.radians(5))
# The rim: samples within so many degrees of the most grazing ones, which are at least so oblique;
# how much a share of R, G or B may be off; and among how many samples the light has to be spread
RIM, OBLIQUE, OFF, SPREAD = 10.0, 60.0, 0.1, 30


def note_on_lobe_colours(
    samples: Samples, fitted: Model, albedos: NDArray[np.float64]
) -> list[str]:
    """The note, if any, on lobes of a model with values that have pure colours of different hues,
    where the highlight of the `Samples` has not; `albedos`: of the lobes (lobes, 3)."""
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
    """The note, if any, on a model with values whose colour at the most grazing of the `Samples` of
    a `Measured` is not theirs."""
    if samples.values.shape[1] != 3 or fitted.wavelengths:
        return []
    cosine = np.minimum(samples.wi[:, 2], samples.wo[:, 2])
    largest = np.degrees(np.arccos(np.clip(cosine.min(), 0, 1)))
    if largest < OBLIQUE:
        return []
    rim = samples.at(cosine < np.cos(np.radians(largest - RIM)))
    light = rim.weight * rim.wi[:, 2] * rim.wo[:, 2]
    if data.is_table:  # whose cells are small in the highlight, and many
        light = light * compute_measure(rim.extents, "solid_angle")
    each = light * np.maximum(rim.values, 0).sum(axis=1)
    if not each.sum() or each.sum() ** 2 < SPREAD * (each**2).sum():
        return []  # dark, or a few bright samples
    here, there = (_shares(light @ values) for values in (fitted.eval(rim.wi, rim.wo), rim.values))
    if np.abs(here - there).max() < OFF:
        return []
    told, measured = (" : ".join(f"{100 * s:.0f}" for s in shares) for shares in (here, there))
    return [
        f"its colour at {largest - RIM:.0f}° to {largest:.0f}° is R : G : B = {told}, where "
        f"{measured} was measured: try another model, or one lobe more"
    ]


def _shares(colour: NDArray[np.float64]) -> NDArray[np.float64]:
    """The shares of R, G and B in a colour; negative ones count as 0."""
    positive = colour.clip(min=0)
    return positive / (positive.sum() + 1e-300)


def _cosine(one: NDArray[np.float64], other: NDArray[np.float64]) -> float:
    """The cosine of the angle between two colours: 1 for one hue."""
    lengths = float(np.linalg.norm(one) * np.linalg.norm(other))
    return float(one @ other) / (lengths + 1e-300)
