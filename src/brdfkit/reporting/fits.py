"""Makes the fits of a report: fits models, and accepts finished or saved fits in their place."""

from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager, nullcontext
from pathlib import Path
from typing import Any

from brdfkit.core.errors import BrdfkitError
from brdfkit.core.progress_bar import Progress
from brdfkit.fitting.fit import fit
from brdfkit.fitting.settings import FitSettings
from brdfkit.materials.loading import load
from brdfkit.materials.measured import Measured
from brdfkit.regression import Fit

ShowProgress = Callable[[str], AbstractContextManager[Progress | None]]


def to_model_list(models: Any) -> list[Any]:
    """Return a list of the models or fits of a report, from one of them or several."""
    single = isinstance(models, str | Path | type | Fit)
    several = [models] if single else list(models)
    if not several:
        raise BrdfkitError("There is no model to report on; give at least one.")
    return several


def fit_models(
    models: Sequence[Any],
    material: Measured,
    settings: FitSettings,
    show: ShowProgress = lambda what: nullcontext(),
) -> tuple[list[Fit], list[BrdfkitError]]:
    """Return the fits of those `models` that can be fitted, and the errors of the other models.

    Raises the first error if no model can be fitted. `settings`: arguments of the fits; `show`: a
    function from the name of a step to a context that shows its progress.
    """
    fits, errors = [], []
    for number, model in enumerate(models, 1):
        try:
            with show(f"fit {model} ({number} of {len(models)})") as progress:
                fits.append(make_fit(model, material, settings, progress))
        except BrdfkitError as error:
            errors.append(error)
    if not fits:
        raise errors[0]
    return fits, errors


def make_fit(
    thing: Any, material: Measured, settings: FitSettings, progress: Progress | None = None
) -> Fit:
    """Return the fit for one entry of a report's models.

    `thing`: a finished fit, the path of a fit saved as .json, or a model, which is fitted. Raises
    `BrdfkitError` as `fit` does, and for a finished fit of other data than the `material`.
    """
    is_saved = isinstance(thing, str | Path) and str(thing).lower().endswith(".json")
    finished = load(thing) if is_saved else thing
    if is_saved and not isinstance(finished, Fit):
        raise BrdfkitError(f"{thing}: is no saved fit; name one, or a model.")
    if not isinstance(finished, Fit):
        return fit(material, thing, **vars(settings), progress=progress)
    if finished.checksum and finished.checksum != material.checksum:
        raise BrdfkitError(
            f"{finished.name} was fitted to {finished.data}, not to the data of {material.name}; "
            "give fits of this material, or names of models."
        )
    return finished
