"""`compare`: a table of the errors and albedos of several models of one measured material."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.core.documents import Cell, Document, Shown, Table
from brdfkit.core.documents.parts import STRONG
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.names import make_unique
from brdfkit.fitting.settings import require_material_first
from brdfkit.images.ball.pixels import Pixels
from brdfkit.materials.measured import Measured
from brdfkit.materials.measured.albedos import ANGLES
from brdfkit.materials.measured.selection import select_samples
from brdfkit.materials.resolve import MaterialLike, to_materials, to_measured
from brdfkit.model.samples.samples import Samples
from brdfkit.regression import Fit, Loss, losses
from brdfkit.regression.albedo import ANISOTROPIC_AZIMUTHS, ISOTROPIC_AZIMUTHS, make_albedo_pixels
from brdfkit.regression.albedo_cells import make_albedo_cell
from brdfkit.regression.losses.loss import sum_squared_differences
from brdfkit.regression.losses.named_losses import DEFAULT

# Losses that every table shows, in addition to those that the compared fits minimised
USUAL_LOSSES = "cosine", "log", "cbrt", "plain"
NEEDED = "name", "eval"  # attributes of what is compared


@dataclass(frozen=True, repr=False)
class Comparison(Shown):
    """Errors and albedos of several BRDFs beside one measured material; prints as a table.

    Attributes
    ----------
    material : str
        Name of the measured material.
    errors : dict
        Errors E by the name of the BRDF, then by the name of the loss. `brdfkit.losses.named` has
        their units. The BRDF with the least cbrt loss is first. An error is nan where the loss
        gives every sample the weight 0.
    albedos : dict
        Directional albedos at 5°, 45° and 75° of incidence, as means over the channels, by the
        name of the BRDF.
    measured_albedo : tuple of float
        Albedos of the measured material at these angles; nan where its samples do not determine
        them.
    shown : tuple of str
        Names of the losses in the table: the usual ones, and those that the compared fits
        minimised.
    """

    material: str
    errors: dict[str, dict[str, float]]
    albedos: dict[str, tuple[float, ...]]
    measured_albedo: tuple[float, ...]
    shown: tuple[str, ...]

    @property
    def best(self) -> str:
        """The name of the BRDF with the least cbrt loss."""
        return next(iter(self.errors))

    def document(self) -> Document:
        """Return the table, with a row for the measurement and one for each BRDF.

        The least error under each loss is bold, and wrong albedos are marked.
        """
        table = np.array([[row[loss] for loss in self.shown] for row in self.errors.values()])
        is_least = table == np.nanmin(np.vstack([table, np.full(len(self.shown), np.inf)]), axis=0)
        kinds = np.where(is_least, STRONG, "").tolist()
        hints = [losses.named[loss].meaning for loss in self.shown]
        measured = "measured", *"-" * len(hints), *map(make_albedo_cell, self.measured_albedo)
        rows = tuple(
            (
                Cell(name),
                *map(Cell, map(format_error, errors), kind, hints),
                *map(make_albedo_cell, self.albedos[name], self.measured_albedo),
            )
            for name, errors, kind in zip(self.errors, table, kinds, strict=True)
        )
        angles = [f"{angle:g}°" for angle in ANGLES]
        columns = ("", *(f">{name}" for name in (*self.shown, *angles)))
        title = f"{self.material}: errors by loss, and albedo at {', '.join(angles)}"
        return Document(title, (Table((measured, *rows), columns),))


def choose_losses_to_show(*minimised: str) -> list[str]:
    """Return the names of the usual losses and of the `minimised` ones, in the usual order.

    >>> choose_losses_to_show("relative")
    ['cosine', 'log', 'cbrt', 'plain', 'relative']
    """
    return [name for name in losses.named.by_sample if name in {*USUAL_LOSSES, *minimised}]


def format_error(error: float) -> str:
    """Return an error as text, or a dash for nan."""
    return "-" if math.isnan(error) else f"{error:.5f}"


def compare(
    material: MaterialLike,
    fits: MaterialLike | Iterable[MaterialLike],
    *,
    max_angle: float = 80.0,
    spectral: bool = False,
) -> Comparison:
    """Compare fits, models or other materials to a measured one: errors in all losses, and albedo.

    Parameters
    ----------
    material : Measured, str or Path
        The measured material, or its name or path.
    fits : Fit, Model, Measured, str, Path or dict, or several
        The BRDFs to compare; equal names are numbered.
    max_angle : float, default 80
        Largest angle to the normal [degrees, above 0 to 90]; samples at or beyond it are left out,
        as in `fit`.
    spectral : bool, default False
        Whether to compare at the measured wavelengths instead of in linear sRGB. Then all `fits`
        must have the same wavelengths.

    Returns
    -------
    Comparison
        The errors, least cbrt loss first, and the albedos; prints as a table.

    Raises
    ------
    BrdfkitError
        Where `material` was not measured, one of `fits` is no material or has other channels, or no
        sample is left.

    Examples
    --------
    >>> print(compare("car_paint", ["ward", fit("car_paint", "ggx")]))    # doctest: +SKIP
    """
    require_material_first("compare(material, fits)", material)
    data, materials = to_measured(material), to_materials(fits, NEEDED)
    samples = select_samples(data, max_angle, spectral=spectral)
    measured_albedo = (data if spectral else data.rgb).albedo
    pixels = make_albedo_pixels(
        ANGLES, ANISOTROPIC_AZIMUTHS if data.anisotropic else ISOTROPIC_AZIMUTHS
    )
    errors: dict[str, dict[str, float]] = {}
    albedos: dict[str, tuple[float, ...]] = {}
    for thing in materials:
        name = make_unique(thing.name, errors)
        brdf: Any = thing if spectral else getattr(thing, "rgb", thing)
        values = _evaluate_at_samples(brdf, data, samples)
        errors[name] = {
            loss: compute_error(losses.named.by_sample[loss], values, samples)
            for loss in losses.named.by_sample
        }
        albedos[name] = _compute_albedos(brdf, pixels)
    errors = dict(sorted(errors.items(), key=lambda item: item[1][DEFAULT]))
    shown = choose_losses_to_show(
        *(thing.loss_name for thing in materials if isinstance(thing, Fit))
    )
    return Comparison(data.name, errors, albedos, measured_albedo.means, tuple(shown))


def _compute_albedos(brdf: Any, pixels: Pixels) -> tuple[float, ...]:
    """Integrate the albedos of a BRDF at `ANGLES`, as means over the channels."""
    if isinstance(brdf, Measured):
        return brdf.albedo.means
    return tuple(pixels.evaluate(brdf.eval).mean(axis=1).tolist())


def _evaluate_at_samples(brdf: Any, data: Measured, samples: Samples) -> FloatArray:
    """Return the values (n, channels) of a BRDF in the directions of the samples of a material.

    Raises `BrdfkitError` if the BRDF and the measured `data` have different channels.
    """
    values: FloatArray = brdf.eval(samples.wi, samples.wo)
    if values.shape[1] not in (1, samples.values.shape[1]):
        raise BrdfkitError(
            f"{brdf.name} has {values.shape[1]} channels and {data.name} "
            f"{samples.values.shape[1]}; compare materials with equal channels."
        )
    return np.broadcast_to(values, samples.values.shape)


def compute_error(loss: Loss, values: FloatArray, samples: Samples) -> float:
    """Return the error E of `values` (n, channels) at samples; nan if all their weights are 0."""
    importance = loss.importance(samples)
    return (
        math.sqrt(importance @ sum_squared_differences(loss, values, samples))
        if importance.any()
        else math.nan
    )
