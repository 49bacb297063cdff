"""`compare`: how well models describe a measured material, as a table."""

import math
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from brdfkit.documents import Cell, Document, Shown, Table
from brdfkit.documents.parts import STRONG
from brdfkit.errors import BrdfkitError
from brdfkit.fitting import losses
from brdfkit.fitting.loss import squares
from brdfkit.fitting.named_losses import DEFAULT
from brdfkit.materials import MaterialLike, materials, measured_material
from brdfkit.measured.selection import select_samples
from brdfkit.names import make_unique

# The losses by which errors are told, beside those that were minimised
USUAL = "cosine", "log", "cbrt", "plain"


@dataclass(frozen=True, repr=False)
class Comparison(Shown):
    """Errors of several BRDFs against one measured material, under every loss; prints as a table.

    Attributes
    ----------
    material : str
        Name of the measured material.
    errors : dict
        Name → loss → E, in the units of `brdfkit.losses`, the best by the cbrt loss first; nan
        where a loss weighs no sample.
    """

    material: str
    errors: dict[str, dict[str, float]]

    @property
    def best(self) -> str:
        """Name of the BRDF with the least cbrt loss."""
        return next(iter(self.errors))

    def document(self) -> Document:
        """The errors, a row for each BRDF and a column for each loss, the least of it strong."""
        names = list(next(iter(self.errors.values())))
        table = np.array([[row[name] for name in names] for row in self.errors.values()])
        is_least = table == np.nanmin(np.vstack([table, np.full(len(names), np.inf)]), axis=0)
        kinds = np.where(is_least, STRONG, "").tolist()
        hints = [losses[name].meaning for name in names]
        rows = tuple(
            (Cell(name), *map(Cell, map(format_error, errors), kind, hints))
            for name, errors, kind in zip(self.errors, table, kinds, strict=True)
        )
        columns = ("", *(f">{name}" for name in names))
        return Document(f"{self.material}: errors by loss", (Table(rows, columns),))


def told(*minimised):
    """The names of the losses by which the errors of fits are told, in the order of `losses`.

    >>> told("relative")
    ['cosine', 'log', 'cbrt', 'plain', 'relative']
    """
    return [name for name in losses.by_sample if name in {*USUAL, *minimised}]


def format_error(error):
    """An error as text; a dash for nan."""
    return "-" if math.isnan(error) else f"{error:.5f}"


def compare(
    data: MaterialLike,
    things: MaterialLike | Iterable[MaterialLike],
    max_angle: float = 80.0,
    spectral: bool = False,
) -> Comparison:
    """Compare fits, models or other materials to a measured one, under every loss.

    Parameters
    ----------
    data : Measured, str or Path
        The measured material, or the name or path of one.
    things : Measured, Fit, Model, str, Path or dict, or several
        What is compared to it; equal names are numbered.
    max_angle : float, default 80
        Samples with an angle to the normal at or beyond it [degrees, above 0 to 90] are left out,
        as in `fit`.
    spectral : bool, default False
        Whether to compare at the measured wavelengths, which `things` should have, too, or else in
        linear sRGB.

    Returns
    -------
    Comparison
        The errors, in the order of the cbrt loss, the best first; prints as a table.

    Raises
    ------
    BrdfkitError
        Where `data` was not measured, one of `things` is no material or has other channels, or no
        sample is left.

    Examples
    --------
    >>> print(compare("car_paint", ["ward", fit("ggx", "car_paint")]))    # doctest: +SKIP
    """
    data, found = measured_material(data), materials(things)
    samples = select_samples(data, max_angle, spectral=spectral)
    errors: dict[str, dict[str, float]] = {}
    for thing in found:
        values = _evaluate(thing, data, samples, spectral)
        errors[make_unique(thing.name, errors)] = {
            name: _error(loss, values, samples) for name, loss in losses.by_sample.items()
        }
    return Comparison(data.name, dict(sorted(errors.items(), key=lambda item: item[1][DEFAULT])))


def _evaluate(thing, data, samples, spectral):
    """The values (n, channels) of `thing` at `Samples` of a `Measured`."""
    shown = thing if spectral else getattr(thing, "rgb", thing)
    values = shown.eval(samples.wi, samples.wo)
    if values.shape[1] not in (1, samples.values.shape[1]):
        raise BrdfkitError(
            f"{thing.name} has {values.shape[1]} channels and {data.name} "
            f"{samples.values.shape[1]}; compare what has the same ones."
        )
    return np.broadcast_to(values, samples.values.shape)


def _error(loss, values, samples):
    """E of a `Loss` for `values` (n, channels) at `Samples`; nan where it weighs none of them."""
    importance = loss.importance(samples)
    return math.sqrt(importance @ squares(loss, values, samples)) if importance.any() else math.nan
