"""`compare`: a table of the errors and albedos of several models of one measured material."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from contextlib import closing
from dataclasses import dataclass
from functools import cached_property
from operator import itemgetter
from typing import Any

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.core.cluster import count_cluster_slots, require_result, run_tasks
from brdfkit.core.documents import Cell, Document, Shown, Table
from brdfkit.core.documents.parts import STRONG
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.names import make_unique
from brdfkit.core.progress_bar import Progress
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
    client: Any = None,
    progress: Progress | None = None,
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
    client : distributed.Client, optional
        A cluster that compares in place of this process, a task for each of `fits`.
    progress : callable, optional
        Called with (BRDFs done, BRDFs in all).

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
    if client is not None:
        count_cluster_slots(client)
    data, materials = to_measured(material), to_materials(fits, NEEDED)
    reference = Reference(data, max_angle, spectral)
    names: list[str] = []
    for thing in materials:
        names.append(make_unique(thing.name, names))
    found = _judge_all(reference, dict(zip(names, materials, strict=True)), client, progress)
    errors = {name: found[name][0] for name in names}
    albedos = {name: found[name][1] for name in names}
    errors = dict(sorted(errors.items(), key=lambda item: item[1][DEFAULT]))
    shown = choose_losses_to_show(
        *(thing.loss_name for thing in materials if isinstance(thing, Fit))
    )
    return Comparison(data.name, errors, albedos, reference.albedo, tuple(shown))


@dataclass(frozen=True, eq=False)
class Reference:
    """The measured material to which BRDFs are compared, as `compare` takes it.

    Its samples are selected once, also in a worker of a cluster.
    """

    data: Measured
    max_angle: float
    spectral: bool

    @cached_property
    def samples(self) -> Samples:
        """The samples at which BRDFs are compared."""
        return select_samples(self.data, self.max_angle, spectral=self.spectral)

    @property
    def albedo(self) -> tuple[float, ...]:
        """The albedos of the material at `ANGLES`."""
        return (self.data if self.spectral else self.data.rgb).albedo.means

    def judge_brdf(self, thing: Any) -> tuple[dict[str, float], tuple[float, ...]]:
        """Return the errors of a BRDF by the name of the loss, and its albedos at `ANGLES`."""
        brdf = thing if self.spectral else getattr(thing, "rgb", thing)
        values = _evaluate_at_samples(brdf, self.data, self.samples)
        named = losses.named.by_sample
        errors = {loss: compute_error(named[loss], values, self.samples) for loss in named}
        turned = ANISOTROPIC_AZIMUTHS if self.data.anisotropic else ISOTROPIC_AZIMUTHS
        return errors, _compute_albedos(brdf, make_albedo_pixels(ANGLES, turned))


def _judge_all(
    reference: Reference, materials: Mapping[str, Any], client: Any, progress: Progress | None
) -> dict[str, Any]:
    """Return what `Reference.judge_brdf` returns of each of several BRDFs, by name."""
    found: dict[str, Any] = {}
    report = progress or (lambda done, total: None)
    report(0, len(materials))
    tasks = run_tasks(
        _judge_named, list(materials.items()), client, shared=reference, describe=itemgetter(0)
    )
    with closing(tasks):
        for (name, _), result in tasks:
            found[name] = require_result(result)
            report(len(found), len(materials))
    return found


def _judge_named(reference: Reference, task: tuple[str, Any]) -> Any:
    """Return what `Reference.judge_brdf` returns of one BRDF, which is given with its name."""
    return reference.judge_brdf(task[1])


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
