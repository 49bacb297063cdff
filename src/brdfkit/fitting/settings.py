"""Checks the settings of a fit: what is wrong with them for any model and any material."""

import os
from pathlib import Path

from brdfkit.core.arguments import to_dictionary, to_number, to_pair, to_whole_number
from brdfkit.core.errors import BrdfkitError, no_such
from brdfkit.fitting.light_of_data import light_of_data
from brdfkit.materials.measured.selection import select_samples
from brdfkit.materials.resolve import to_measured
from brdfkit.model import Model, labels
from brdfkit.regression import Fit, to_loss
from brdfkit.regression.refitting import Refit
from brdfkit.regression.robust.reweighting import WEIGHTS
from brdfkit.regression.solvers.settings import require_suitable, to_constraints, to_solver


def refit(fit, data):
    """The `Refit` of a fit and the material that was fitted."""
    samples = fitted_samples(fit, data)
    material = to_measured(data)
    material = material if fit.wavelengths else material.rgb
    light = light_of_data(material, None, fit.settings.get("max_angle", 80.0))
    return Refit(fit, samples, light)


def require_material_first(call: str, material: object) -> None:
    """Raise `BrdfkitError` where a model stands in the place of the material, as it does in
    `fit("ggx", paint)`; `call` is the right order, as "fit(material, model)"."""
    several = material if isinstance(material, list | tuple) else [material]
    if several and all(map(_is_model, several)):
        raise BrdfkitError(
            f"{material!r:.60} is a model, where the measured material belongs: {call}."
        )


def _is_model(given: object) -> bool:
    """Whether an argument can only mean a model: a fit, a model, its class, file or label."""
    if isinstance(given, str | Path):
        is_file = os.path.isfile(given)
        return str(given).endswith(".py") or (not is_file and labels.is_label(str(given)))
    return isinstance(given, Fit | Model) or (isinstance(given, type) and issubclass(given, Model))


def fitted_samples(fit, data):
    """The `Samples` of a material that were fitted; with standard errors, where these counted."""
    if not isinstance(fit, Fit):
        raise BrdfkitError(
            f"Here a Fit is needed first, then the material, not a {type(fit).__name__}; make one "
            "by fit(material, model)."
        )
    settings, data = fit.settings, to_measured(data)
    errors = settings.get("use_standard_error", False)
    return select_samples(
        data, settings.get("max_angle", 80.0), errors=errors, spectral=bool(fit.wavelengths)
    )


def to_settings(settings, where):
    """The settings of a fit by name, checked, in the types that a fit takes; see `check_settings`
    of `brdfkit.fitting.fit`."""
    settings = dict(settings)
    loss, robust = settings["loss"], settings["robust"]
    if not isinstance(loss, str):
        raise BrdfkitError(
            f"loss = {loss!r} is no name; where other processes fit, it should be one of "
            "brdfkit.losses.named."
        )
    to_loss(loss)
    if robust not in (None, *WEIGHTS):
        raise no_such("robust weight", robust, WEIGHTS)
    settings["solver"] = to_solver(settings["solver"])
    settings["constraints"] = to_constraints(settings["constraints"])
    require_suitable(settings["solver"], settings["constraints"], robust)
    if settings["starts"] is not None:
        settings["starts"] = to_whole_number("starts", settings["starts"], least=1)
    settings["seed"] = to_whole_number("seed", settings["seed"], least=0)
    bounds = to_dictionary("bounds", settings["bounds"])
    settings["bounds"] = {n: to_pair(f"{where}the bounds of {n}", v) for n, v in bounds.items()}
    settings["fixed"] = to_dictionary("fixed", settings["fixed"])
    to_number("max_angle", settings["max_angle"], above=0, most=90)
    return settings


def require_plain(**given):
    """Raise `BrdfkitError` for arguments that look at samples or wavelengths one by one, many of
    which a picture shows in one pixel."""
    for name, value in given.items():
        if value is not None and value is not False:
            raise BrdfkitError(
                f"{name} looks at samples one by one, and the loss picture at pixels, which mix "
                f"many; leave {name} out, or choose another loss."
            )
