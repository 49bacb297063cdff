"""Writes notes on lobes of a fit that have no physical meaning, although the search converged.

A lobe is one term of a model, such as its diffuse part or one of its highlights.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from brdfkit.core.names import join_words
from brdfkit.fitting.lobe_colours import note_on_grazing_colour, note_on_lobe_colours
from brdfkit.fitting.lobe_widths import (
    compute_half_widths,
    find_lobes_with_parameter,
    find_width_exponent,
    list_narrow_lobe_notes,
)
from brdfkit.materials.measured import Measured
from brdfkit.model import Model
from brdfkit.model.evaluation import compute_lobe_values, to_weight_matrix
from brdfkit.model.samples import Samples
from brdfkit.regression.albedo import make_albedo_pixels

INCIDENCES = 5, 45, 75  # angles of incidence at which the albedo of a lobe is computed [degrees]
GAIN = 1.05  # a lobe with a larger albedo reflects more than arrives: 1, with a tolerance of 5 %
LARGEST_IOR = 5.0  # no surface has a larger index of refraction
# A highlight whose albedo at 5° is below METALLIC belongs to a non-metal. Fresnel reflection should
# then raise its albedo at least by the factor RISE from 5° to 75°
METALLIC, RISE = 0.2, 1.1
BROAD = 20.0  # a lobe with a larger half width [degrees] is hardly a highlight
FLAT = "the highlight does not rise towards grazing angles, as the highlight of a non-metal should"


def list_lobe_notes(
    data: Measured, samples: Samples, fitted: Model, at_bounds: tuple[str, ...]
) -> list[str]:
    """Return notes, as sentences, on lobes of a fitted model that have no physical meaning.

    Parameters
    ----------
    data : Measured
        The material.
    samples : Samples
        The samples of the material that were fitted.
    fitted : Model
        The model with the fitted values.
    at_bounds : tuple of str
        Names of the parameters that ended on a bound.

    Returns
    -------
    list of str
        Sentences on lobes that reflect more light than arrives, that have weight 0, that are
        narrower than the spacing of the samples, or whose pure colours the highlight lacks; on
        parameters at their bounds; on impossible Fresnel parameters; and on a wrong colour at
        grazing angles.

    Examples
    --------
    >>> ward = models()["ward"](specular_reflectance=208)
    >>> list_lobe_notes(paint, samples, ward, ())    # doctest: +SKIP
    """
    if fitted.has_signed_weights():  # lobes that cancel each other have no meaning alone
        return []
    albedos = compute_lobe_albedos(fitted)
    diffuse = np.array([lobe.diffuse for lobe in fitted.lobes()])
    highlight = albedos[:, ~diffuse].sum(axis=1).max(axis=1)
    narrow = list_narrow_lobe_notes(samples, fitted)
    others = tuple(name for name in at_bounds if name not in narrow)
    other_unit = data.rgb.albedo.has_another_unit  # then its albedos mean nothing
    return [
        *([] if other_unit else _list_amplifying_lobes(fitted, albedos)),
        *(
            f"the lobe of {name} is not used: its weight is 0"
            for name, lobe in fitted.terms()
            if name in at_bounds and not lobe.diffuse and not np.any(getattr(fitted, name))
        ),
        *(
            f"{name} ended on its bound, {fitted.parameters[name].bounds[1]:g}: the material is "
            "brighter than the model can be, as a metal or a diffuse surface"
            for name in fitted.weights()
            if name in at_bounds and np.any(getattr(fitted, name))
        ),
        *_list_impossible_fresnel_values(fitted),
        *_list_parameters_at_bounds(fitted, others, highlight),
        *narrow.values(),
        *note_on_lobe_colours(samples, fitted, albedos[INCIDENCES.index(45)]),
        *note_on_grazing_colour(data, samples, fitted),
    ]


def compute_lobe_albedos(model: Model) -> NDArray[np.float64]:
    """Return the directional albedos (incidences, lobes, channels) of the lobes of a model.

    Lobes are the terms of the model, here times their weights. The incidences are `INCIDENCES`.
    """
    both = make_albedo_pixels(INCIDENCES).evaluate(
        lambda wi, wo: np.hstack(compute_lobe_values(model, wi, wo))
    )
    plain, squared = np.split(both[..., None], 2, axis=1)
    weights = to_weight_matrix(model)
    return plain * weights + squared * weights**2


def _list_amplifying_lobes(fitted: Model, albedos: NDArray[np.float64]) -> list[str]:
    """Return a sentence on each lobe that reflects more light than arrives.

    `albedos` (incidences, lobes, channels) are the albedos of the lobes.
    """
    notes = []
    for name, weight, albedo in zip(
        fitted.weights(), to_weight_matrix(fitted), albedos.max(axis=2).T, strict=True
    ):
        if albedo.max() > GAIN:
            degrees = INCIDENCES[int(albedo.argmax())]
            notes.append(
                f"{name} = {weight.max():.3g} makes its lobe alone reflect {albedo.max():.2f} of "
                f"the light at {degrees}°: AlbedoAtMost(1), --albedo-at-most 1, prevents it"
            )
    return notes


def _list_impossible_fresnel_values(fitted: Model) -> list[str]:
    """Return a sentence on each Fresnel parameter whose value is impossible for a real surface."""
    values = {name: getattr(fitted, name) for name in fitted.shapes()}
    high = [
        n for n, value in values.items() if _is_parameter_of_kind(n, "ior") and value > LARGEST_IOR
    ]
    above = [n for n, value in values.items() if _is_parameter_of_kind(n, "f0") and value > 1]
    return [
        *(
            f"{name} = {values[name]:.3g} is the index of refraction of no surface: it says only "
            "that the lobe hardly rises towards grazing angles"
            for name in _keep_parameters_of_used_lobes(fitted, high)
        ),
        *(
            f"{name} = {values[name]:.3g} is a reflectance above 1: only its product with the "
            "weight means something"
            for name in _keep_parameters_of_used_lobes(fitted, above)
        ),
    ]


def _list_parameters_at_bounds(
    fitted: Model, at_bounds: tuple[str, ...], highlight: NDArray[np.float64]
) -> list[str]:
    """Return sentences on the shape parameters in `at_bounds`, which ended on their bounds.

    Parameters of lobes with weight 0 are left out. `highlight` (incidences,) is the albedo of all
    lobes except the diffuse ones.
    """
    by_meaning: dict[str, list[str]] = {}
    shapes = [n for n in fitted.shapes(anisotropic=True) if n in at_bounds]
    for name in _keep_parameters_of_used_lobes(fitted, shapes):
        if meaning := _explain_bound(fitted, name, highlight):
            by_meaning.setdefault(meaning, []).append(name)
    notes = []
    for meaning, names in by_meaning.items():
        values = join_words([f"{name} = {getattr(fitted, name):.3g}" for name in names])
        what = "its bound" if len(names) == 1 else "their bounds"
        notes.append(f"{values} ended on {what}: {meaning}")
    return notes


def _explain_bound(fitted: Model, name: str, highlight: NDArray[np.float64]) -> str:
    """Return a clause on what it means that the shape parameter `name` ended on a model's bound.

    It is empty where this is usual, and where the bound is the user's own. `highlight`
    (incidences,) is the albedo of all lobes except the diffuse ones.
    """
    value, width = getattr(fitted, name), find_width_exponent(fitted, name)
    low, high = fitted.parameters[name].bounds
    upper = math.isclose(value, high, rel_tol=1e-5)
    if not upper and not math.isclose(value, low, rel_tol=1e-5, abs_tol=1e-9):
        return ""
    if _is_parameter_of_kind(name, "ior") and fitted.fixed_lobes():
        return ""  # its lobe has no weight, and may well be black
    if (_is_parameter_of_kind(name, "f0") or _is_parameter_of_kind(name, "ior")) and not upper:
        return "such a lobe shines at grazing angles alone, and its weight is no reflectance"
    if _is_parameter_of_kind(name, "f0"):  # f0 = 1 is usual for metals, and for one lobe of several
        is_flat = highlight[0] < METALLIC and highlight[-1] < RISE * highlight[0]
        return FLAT if is_flat else ""
    if width and upper == (width < 0):
        return "such a lobe is as narrow as the model allows, and its width is a guess"
    # The half width along the narrower axis excludes streaks, which are broad along one axis only
    if width and compute_half_widths(fitted)[find_lobes_with_parameter(fitted, name)].min() > BROAD:
        return (
            "such a lobe is as broad as the model allows, hardly a highlight; one lobe fewer may do"
        )
    return ""


def _keep_parameters_of_used_lobes(fitted: Model, names: list[str]) -> list[str]:
    """Return those of the shape parameters `names` that change a lobe whose weight is not 0."""
    lit = to_weight_matrix(fitted).any(axis=1)
    return [name for name in names if lit[find_lobes_with_parameter(fitted, name)].any()]


def _is_parameter_of_kind(name: str, kind: str) -> bool:
    """Return whether a parameter is of a `kind`, such as "ggx_2_f0" of the kind "f0"."""
    return name == kind or name.endswith(f"_{kind}")
