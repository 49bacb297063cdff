"""A fit made ready to be fitted again, as the bootstrap and the profile do."""

from brdfkit.core.errors import BrdfkitError
from brdfkit.fitting.light_of_data import light_of_data
from brdfkit.materials.measured.selection import select_samples
from brdfkit.materials.resolve import measured_material
from brdfkit.regression import Fit
from brdfkit.regression.refitting import Refit


def refit(fit, data):
    """The `Refit` of a fit and the material that was fitted."""
    samples = fitted_samples(fit, data)
    material = measured_material(data)
    material = material if fit.wavelengths else material.rgb
    light = light_of_data(material, None, fit.settings.get("max_angle", 80.0))
    return Refit(fit, samples, light)


def fitted_samples(fit, data):
    """The `Samples` of a material that were fitted; with standard errors, where these counted."""
    if not isinstance(fit, Fit):
        raise BrdfkitError(f"Here a Fit is needed, not a {type(fit).__name__}; make one by fit.")
    settings, data = fit.settings, measured_material(data)
    errors = settings.get("use_standard_error", False)
    return select_samples(
        data, settings.get("max_angle", 80.0), errors=errors, spectral=bool(fit.wavelengths)
    )
