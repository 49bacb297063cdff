"""Notes on lobes of a fit that have no physical meaning, although the search converged."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from brdfkit.core.names import join_words
from brdfkit.fitting.lobe_colours import note_on_lobe_colours, note_on_rim
from brdfkit.fitting.lobe_widths import half_widths, lobes_of, notes_on_widths, width_power
from brdfkit.materials.measured import Measured
from brdfkit.model import Model
from brdfkit.model.evaluation import compute_lobe_values, to_weight_matrix
from brdfkit.model.samples import Samples
from brdfkit.regression.light import make_albedo_pixels

# The incidences at which the albedo of a lobe is computed [degrees], and the albedo above which it
# reflects more than arrives
INCIDENCES, GAIN = (5, 45, 75), 1.05
# No surface has an index of refraction above this
LARGEST_IOR = 5.0
# A highlight with a smaller albedo at 5° is not a metal's, and should rise by this factor to 75°
METALLIC, RISE = 0.2, 1.1
# A lobe with a larger half width than this is hardly a highlight [degrees]
BROAD = 20.0
FLAT = "the highlight does not rise towards grazing angles, as the highlight of a non-metal should"


def list_lobe_notes(
    data: Measured, samples: Samples, fitted: Model, at_bounds: tuple[str, ...]
) -> list[str]:
    """Return sentences on lobes that have no physical meaning.

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
        Sentences on lobes that reflect more light than arrives, are not used, are narrower than
        the samples can show, or have pure colours that the highlight lacks; on parameters at their
        bounds; on Fresnel parameters that no surface has; and on a wrong colour at grazing angles.

    Examples
    --------
    >>> ward = models()["ward"](specular_reflectance=208)
    >>> list_lobe_notes(paint, samples, ward, ())    # doctest: +SKIP
    """
    if fitted.has_signed_weights():  # then only the sum of the terms has a meaning
        return []
    albedos = lobe_albedos(fitted)
    diffuse = np.array([lobe.diffuse for lobe in fitted.lobes()])
    highlight = albedos[:, ~diffuse].sum(axis=1).max(axis=1)
    narrow = notes_on_widths(samples, fitted)
    others = tuple(name for name in at_bounds if name not in narrow)
    other_unit = data.rgb.albedo.has_another_unit  # then no lobe means anything
    return [
        *([] if other_unit else _list_gains(fitted, albedos)),
        *_list_unused(fitted, at_bounds),
        *_list_fresnel(fitted),
        *_list_bounds(fitted, others, highlight),
        *narrow.values(),
        *note_on_lobe_colours(samples, fitted, albedos[INCIDENCES.index(45)]),
        *note_on_rim(data, samples, fitted),
    ]


def lobe_albedos(model: Model) -> NDArray[np.float64]:
    """Return the directional albedo (incidences, lobes, channels) of each lobe with its weight."""
    both = make_albedo_pixels(INCIDENCES).look(
        lambda wi, wo: np.hstack(compute_lobe_values(model, wi, wo))
    )
    plain, squared = np.split(both[..., None], 2, axis=1)
    weights = to_weight_matrix(model)
    return plain * weights + squared * weights**2


def _list_gains(fitted: Model, albedos: NDArray[np.float64]) -> list[str]:
    """Return a sentence on each lobe that reflects more light than arrives, even alone."""
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


def _list_unused(fitted: Model, at_bounds: tuple[str, ...]) -> list[str]:
    """Return a sentence on each lobe with weight 0, except diffuse ones."""
    return [
        f"the lobe of {name} is not used: its weight is 0"
        for name, lobe in fitted.terms()
        if name in at_bounds and not lobe.diffuse
    ]


def _list_fresnel(fitted: Model) -> list[str]:
    """Return a sentence on each Fresnel parameter with a value that no surface has."""
    values = {name: getattr(fitted, name) for name in fitted.shapes()}
    high = [n for n, value in values.items() if _is(n, "ior") and value > LARGEST_IOR]
    above = [n for n, value in values.items() if _is(n, "f0") and value > 1]
    return [
        *(
            f"{name} = {values[name]:.3g} is the index of refraction of no surface: it says only "
            "that the lobe hardly rises towards grazing angles"
            for name in _of_lit_lobes(fitted, high)
        ),
        *(
            f"{name} = {values[name]:.3g} is a reflectance above 1: only its product with the "
            "weight means something"
            for name in _of_lit_lobes(fitted, above)
        ),
    ]


def _list_bounds(
    fitted: Model, at_bounds: tuple[str, ...], highlight: NDArray[np.float64]
) -> list[str]:
    """Return sentences on the shape parameters of used lobes that ended on their bounds.

    `highlight` is the albedo (incidences,) of all lobes except the diffuse ones.
    """
    by_meaning: dict[str, list[str]] = {}
    shapes = [n for n in fitted.shapes(anisotropic=True) if n in at_bounds]
    for name in _of_lit_lobes(fitted, shapes):
        if meaning := _explain_bound(fitted, name, highlight):
            by_meaning.setdefault(meaning, []).append(name)
    notes = []
    for meaning, names in by_meaning.items():
        values = join_words([f"{name} = {getattr(fitted, name):.3g}" for name in names])
        what = "its bound" if len(names) == 1 else "their bounds"
        notes.append(f"{values} ended on {what}: {meaning}")
    return notes


def _explain_bound(fitted: Model, name: str, highlight: NDArray[np.float64]) -> str:
    """Return what it means that the shape parameter `name` ended on a bound of the model.

    The text is empty where this is usual, and where the user set the bound.
    """
    value, width = getattr(fitted, name), width_power(fitted, name)
    low, high = fitted.parameters[name].bounds
    upper = math.isclose(value, high, rel_tol=1e-5)
    if not upper and not math.isclose(value, low, rel_tol=1e-5, abs_tol=1e-9):
        return ""
    if (_is(name, "f0") or _is(name, "ior")) and not upper:
        return "such a lobe shines at grazing angles alone, and its weight is no reflectance"
    if _is(name, "f0"):  # usual for metals, and for one lobe of several
        is_flat = highlight[0] < METALLIC and highlight[-1] < RISE * highlight[0]
        return FLAT if is_flat else ""
    if width and upper == (width < 0):
        return "such a lobe is as narrow as the model allows, and its width is a guess"
    if width and half_widths(fitted)[lobes_of(fitted, name)].min() > BROAD:
        return (
            "such a lobe is as broad as the model allows, hardly a highlight; one lobe fewer may do"
        )
    return ""  # also for a streak, which is broad along one axis only


def _of_lit_lobes(fitted: Model, names: list[str]) -> list[str]:
    """Return the shape parameters among `names` that belong to a lobe that is not black."""
    lit = to_weight_matrix(fitted).any(axis=1)
    return [name for name in names if lit[lobes_of(fitted, name)].any()]


def _is(name: str, what: str) -> bool:
    """Return whether `name` is the parameter `what`, alone or of a term, as f0 in "ggx_2_f0"."""
    return name == what or name.endswith(f"_{what}")
