"""Draws materials at random from brdfkit's models, as a prior that needs no measured files.

A material is a diffuse term, one or two highlights, and now and then a lobe back to the light. Each
is one of brdfkit's models with parameters drawn broadly: widths, strengths and albedos evenly in
their logarithms.
"""

from typing import Any

import numpy as np

from brdfkit.core.array_types import AnyArray, FloatArray
from brdfkit.model import labels

METALS = 1 / 3  # the share of materials that are metals
SECOND_HIGHLIGHT, BACK = 0.6, 0.15  # the shares of materials that have these lobes


def draw_material(rng: np.random.Generator) -> list[Any]:
    """Return models with values, of which the sum is one random material of one channel."""
    metal = rng.random() < METALS
    parts = [draw_diffuse(rng, 0.05 if metal else 0.9)]
    alpha, f0 = log_uniform(rng, 0.003, 1.0), draw_f0(rng, metal)
    parts.append(draw_highlight(rng, alpha, f0, log_uniform(rng, 0.1, 1.0)))
    if rng.random() < SECOND_HIGHLIGHT:
        wider = log_uniform(rng, 0.003, 1.0)
        parts.append(draw_highlight(rng, wider, f0, log_uniform(rng, 0.1, 1.0)))
    if rng.random() < BACK:
        parts.append(draw_back_lobe(rng))
    return parts


def draw_diffuse(rng: np.random.Generator, largest: float) -> Any:
    """Return a diffuse model with an albedo up to `largest`."""
    albedo = log_uniform(rng, 0.003, largest)
    name = rng.choice(["lambert", "oren_nayar", "burley"])
    values = {"oren_nayar": {"sigma": rng.uniform(0, 0.8)}, "burley": {"roughness": rng.random()}}
    return labels.model(str(name))(diffuse_reflectance=albedo, **values.get(str(name), {}))


def draw_f0(rng: np.random.Generator, metal: bool) -> float:
    """Return the reflectance at normal incidence of a metal, or of plastic, glass or lacquer."""
    return rng.uniform(0.2, 0.98) if metal else log_uniform(rng, 0.02, 0.12)


def draw_highlight(rng: np.random.Generator, alpha: float, f0: float, strength: float) -> Any:
    """Return a model of a highlight alone, of width `alpha`."""
    name = str(rng.choice(["ggx", "ggx", "student_t", "cook_torrance"]))
    values: dict[str, float] = {"f0": f0, "alpha" if name == "cook_torrance" else "alpha_u": alpha}
    if name == "student_t":
        values["gamma"] = log_uniform(rng, 1.6, 20.0)
    return labels.model(name)(diffuse_reflectance=0.0, specular_reflectance=strength, **values)


def draw_back_lobe(rng: np.random.Generator) -> Any:
    """Return a lobe towards the light."""
    return labels.model("lafortune")(
        diffuse_reflectance=0.0,
        specular_reflectance=log_uniform(rng, 0.003, 0.1),
        c_x=0.7,
        c_z=0.7,
        exponent=log_uniform(rng, 1.0, 30.0),
    )


def log_uniform(rng: np.random.Generator, low: float, high: float) -> float:
    """Return a random number between `low` and `high`, evenly in its logarithm."""
    return float(np.exp(rng.uniform(np.log(low), np.log(high))))


def evaluate_parts(parts: list[Any], wi: AnyArray, wo: AnyArray) -> FloatArray:
    """Return the BRDF (n,) of a material of one channel."""
    return np.sum([np.asarray(part.eval(wi, wo))[:, 0] for part in parts], axis=0)
