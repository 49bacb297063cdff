"""The fits of a report: of models, finished, or saved."""

from contextlib import nullcontext
from pathlib import Path

from brdfkit.core.errors import BrdfkitError
from brdfkit.fitting.fit import fit
from brdfkit.materials.loading import load
from brdfkit.regression import Fit


def as_list(things):
    """One model or fit or several as a list; at least one."""
    found = [things] if isinstance(things, str | Path | type | Fit) else list(things)
    if not found:
        raise BrdfkitError("There is no model to report on; give at least one.")
    return found


def fit_each(things, material, settings, show=lambda what: nullcontext()):
    """The fits of those `things` that can be fitted, and the errors of the others.

    `show`: gives, for what is done, a context with a function (done, total) that shows its
    progress, or with None. Raises the first `BrdfkitError` where none can be fitted.
    """
    fits, failed = [], []
    for number, thing in enumerate(things, 1):
        try:
            with show(f"fit {thing} ({number} of {len(things)})") as progress:
                fits.append(to_fit(thing, material, settings, progress))
        except BrdfkitError as error:
            failed.append(error)
    if not fits:
        raise failed[0]
    return fits, failed


def to_fit(thing, material, settings, progress=None):
    """The fit of a model to a `Measured`, or a finished one, or the one saved in a .json file.

    Raises `BrdfkitError` as `fit` does, and for a fit of other data.
    """
    saved = isinstance(thing, str | Path) and str(thing).lower().endswith(".json")
    found = load(thing) if saved else thing
    if saved and not isinstance(found, Fit):
        raise BrdfkitError(f"{thing}: is no saved fit; name one, or a model.")
    if not isinstance(found, Fit):
        return fit(material, thing, **settings, progress=progress)
    if found.checksum and found.checksum != material.checksum:
        raise BrdfkitError(
            f"{found.name} was fitted to other data, {found.data}, than {material.name} has; give "
            "fits of this material, or names of models."
        )
    return found
