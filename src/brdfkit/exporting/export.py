"""`export`: writes a fitted material for another renderer, and says what it lost."""

from __future__ import annotations

import shlex
from dataclasses import dataclass, field
from pathlib import Path

from brdfkit.core.errors import BrdfkitError
from brdfkit.core.files import require_writable
from brdfkit.exporting.comment import make_comment
from brdfkit.exporting.hold import hold
from brdfkit.exporting.loss import Drawable, Loss
from brdfkit.exporting.target import Target
from brdfkit.exporting.targets import find_target
from brdfkit.materials.measured import Measured
from brdfkit.materials.resolve import MaterialLike, to_material
from brdfkit.model import Model
from brdfkit.regression import Fit

TOLERANCE = 2.0  # largest mean ΔE of the ball that is written without being asked


@dataclass(frozen=True)
class Export:
    """The result of `export`, which prints as one line: the files, and what was lost.

    Attributes
    ----------
    paths : tuple of Path
        The files that were written, the main one first.
    target : str
        Name of the target.
    drawn : Model, Measured or another object with ``eval``
        What the target draws. `plot` and `compare` take all of these.
    log_error : float
        RMS difference of ln(f cosθ_i cosθ_o + 0.001) between the fit and what the target draws,
        over random pairs of directions to 80°: 0.1 is about 10 %.
    delta_e : float
        Mean colour difference ΔE2000 of a ball in a studio's light.
    changes : tuple of str
        What the target does not hold, each in words; empty where nothing was lost.
    """

    paths: tuple[Path, ...]
    target: str
    drawn: Drawable = field(repr=False)  # tables are long
    log_error: float
    delta_e: float
    changes: tuple[str, ...]

    def __str__(self) -> str:
        lost = f"{'; '.join(self.changes)}: {Loss(self.log_error, self.delta_e)}"
        lost = lost if self.changes else "nothing lost"
        return f"{', '.join(map(str, self.paths))} ({lost})"


def export(
    fit: MaterialLike,
    target: str,
    path: str | Path,
    *,
    accept_loss: bool = False,
    command: str | None = None,
) -> Export:
    """Write a fitted material for another renderer, and say what it lost.

    What the target can hold is written exactly. Anything else is fitted to the target's own formula
    first, and compared with what the target will draw.

    Parameters
    ----------
    fit : Fit, Model, str or Path
        The fit, the path of a saved one, or a model with values.
    target : str
        Name of the target; ``brdfkit export`` without arguments lists them.
    path : str or Path
        The file to write; its suffix is the target's.
    accept_loss : bool, default False
        Whether to write a file whose ball differs visibly, by a mean ΔE2000 above 2.
    command : str, optional
        The command that repeats the export, for the comment in the file. Default: this call.

    Returns
    -------
    Export
        The files, and what was lost.

    Raises
    ------
    BrdfkitError
        For an unknown target, a measured material, which has to be fitted first, a path that cannot
        be written, and a loss that is visible and not accepted. Nothing is written then.

    Examples
    --------
    >>> print(export(fit("car_paint", "ggx"), "osl", "paint.osl"))    # doctest: +SKIP
    paint.osl (nothing lost)
    """
    aim = find_target(target)
    path = aim.check_path(path)
    thing = _to_fit_or_model(fit)
    require_writable(path)
    held, loss = hold(thing, aim)
    if loss.delta_e > TOLERANCE and not accept_loss:
        raise BrdfkitError(
            f"{thing.name}: {aim.name} would draw it with a mean ΔE of {loss.delta_e:.1f} "
            f"({'; '.join(held.changes)}); {_describe_remedy(aim)}, or accept the loss "
            "(--accept-loss, accept_loss=True)."
        )
    command = command or _describe_call(fit, aim, path, accept_loss)
    files = aim.write(held, path, make_comment(thing, held, loss, command))
    numbers = loss.log_error, loss.delta_e
    return Export(tuple(files), aim.name, held.drawn, *numbers, held.changes)


def _describe_remedy(target: Target) -> str:
    """Return in words how an export loses less."""
    if target.any_form:
        return "choose another target"
    return f"fit a model that it holds (-m best --exportable {target.name})"


def _describe_call(fit: MaterialLike, target: Target, path: Path, accept_loss: bool) -> str:
    """Return the command that repeats an export, or in Python the call."""
    if isinstance(fit, str | Path):
        words = ["brdfkit", "export", str(fit), target.name, "-o", str(path)]
        return shlex.join([*words, *["-a"] * accept_loss])
    kind = "model" if isinstance(fit, Model) else "fit"
    accepted = ", accept_loss=True" * accept_loss
    return f"bk.export({kind}, {target.name!r}, {str(path)!r}{accepted})"


def _to_fit_or_model(thing: MaterialLike) -> Fit | Model:
    """Return the fit or model that is or is named by `thing`; refuse anything else."""
    material = to_material(thing)
    if isinstance(material, Fit | Model):
        return material
    if isinstance(material, Measured):
        raise BrdfkitError(
            f"{material.name} was measured; fit a model to it first (brdfkit fit), and export the "
            "fit. brdfkit convert writes it as a table."
        )
    raise BrdfkitError(f"{material.name} is no fit and no model of brdfkit; give one of these.")
