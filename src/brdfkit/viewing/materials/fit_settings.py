"""The settings of a fit as a page has them: their controls, their checks and their use.

The names begin with "fit.". "fit.fixed" is a list of shape parameters of the model that is shown,
which a fit keeps at their values; "fit.bounds" is a text such as "alpha_u=0.01,0.5".
"""

from __future__ import annotations

from functools import partial
from typing import Any

from brdfkit.core.errors import BrdfkitError
from brdfkit.fitting.settings import FitSettings
from brdfkit.materials.measured import Measured
from brdfkit.model import Model
from brdfkit.regression import Fit
from brdfkit.regression.losses.named_losses import DEFAULT, named
from brdfkit.regression.robust.reweighting import WEIGHTS
from brdfkit.viewing.controls import Control, State
from brdfkit.viewing.materials.parameter_state import PREFIX

FIXED, BOUNDS = "fit.fixed", "fit.bounds"
UNBOUNDED: State = {FIXED: [], BOUNDS: ""}  # as they are for another model
PANEL = "settings"
USUAL = FitSettings()
ASYMMETRY = (("", "as measured"), ("no", "always isotropic"), ("yes", "always anisotropic"))
LONGEST = 200  # characters of the bounds
# Of a fit that a script can repeat: what the page sets, besides the loss
REPEATED = (
    *("robust", "max_angle", "extrapolate", "use_standard_error"),
    *("seed", "starts", "bounds", "fixed"),
)


def make_fit_controls() -> list[Control]:
    """Return the controls of the settings of a fit, the loss first."""
    losses = tuple((name, name) for name in named)
    meaning = "The error that a fit makes small."
    loss: dict[str, Any] = {"default": DEFAULT, "kind": "choice", "choices": losses}
    control = partial(Control, panel=PANEL)
    robust = (("", "every sample counts"), *((name, name) for name in WEIGHTS))
    outliers = "Whether samples that no model meets count less, and by which weight function."
    angle = "Samples whose light or view is farther from the normal are left out."
    errors = "Samples with a large standard error count less, where the measurement states it."
    azimuth = "Whether the widths along x and y are searched apart."
    ranges = "Search a parameter only in a range, as in alpha_u=0.01,0.5; a space before the next."
    return [
        Control("fit.loss", "Loss", "fit", help=meaning, **loss),
        control("fit.robust", "Outliers", default="", kind="choice", choices=robust, help=outliers),
        control(
            "fit.max_angle",
            "Largest angle",
            default=USUAL.max_angle,
            low=10,
            high=90,
            unit="°",
            help=angle,
        ),
        control(
            "fit.anisotropic", "Widths", default="", kind="choice", choices=ASYMMETRY, help=azimuth
        ),
        control(BOUNDS, "Bounds", default="", kind="words", help=ranges),
        control(
            "fit.use_standard_error",
            "weigh by error",
            default=True,
            kind="flag",
            help=errors,
        ),
    ]


def check_fixed(model: type[Model], names: Any) -> list[str]:
    """Return the names of the parameters that a fit keeps; raise `BrdfkitError` for others."""
    if not isinstance(names, list) or not all(isinstance(name, str) for name in names):
        raise BrdfkitError("The parameters that a fit keeps should be a list of names.")
    return [_require_shape(model, name) for name in dict.fromkeys(names)]


def check_bounds(model: type[Model], text: Any) -> str:
    """Return the text of the bounds; raise `BrdfkitError` for one that makes no sense."""
    if not isinstance(text, str) or len(text) > LONGEST:
        raise BrdfkitError("The bounds should be a text such as alpha_u=0.01,0.5.")
    parse_bounds(model, text)
    return " ".join(text.split())


def parse_bounds(model: type[Model], text: str) -> dict[str, tuple[float, float]]:
    """Return the bounds that a text describes, by the names of parameters.

    >>> parse_bounds(models()["ggx"], "f0=0,0.1")    # doctest: +SKIP
    {'f0': (0.0, 0.1)}
    """
    bounds = {}
    for word in text.split():
        name, _, numbers = word.partition("=")
        try:
            low, high = map(float, numbers.split(","))
        except ValueError:
            raise BrdfkitError(
                f"Bounds {word!r:.40} should read NAME=LOW,HIGH, as alpha_u=0.01,0.5."
            ) from None
        bounds[_require_shape(model, name)] = low, high
    return bounds


def _require_shape(model: type[Model], name: str) -> str:
    """Return the name of a shape parameter; raise `BrdfkitError` for another one."""
    shapes = model.shapes(anisotropic=True)
    if name not in shapes:
        raise BrdfkitError(
            f"{name!r:.40} is no parameter that a fit searches; these are "
            f"{', '.join(shapes) or 'none'}."
        )
    return name


def to_fit_arguments(state: State, model: type[Model], is_shown: bool = True) -> dict[str, Any]:
    """Return the arguments of `brdfkit.fit` that a page's settings say, without usual ones.

    What is fixed and bounded concerns only the model that is shown.
    """
    anisotropic = {"yes": True, "no": False}.get(state["fit.anisotropic"])
    given: dict[str, Any] = {
        "robust": state["fit.robust"] or None,
        "max_angle": state["fit.max_angle"],
        "use_standard_error": state["fit.use_standard_error"],
        "anisotropic": anisotropic,
    }
    if is_shown:
        apart = {n for n, p in model.parameters.items() if p.follows}
        apart &= {name for name in state[FIXED] if not state.get(f"{PREFIX}{name}.tied")}
        kept = [n for n in state[FIXED] if n in apart or not model.parameters[n].follows]
        given["fixed"] = {name: state[PREFIX + name] for name in kept} or None
        given["bounds"] = parse_bounds(model, state[BOUNDS]) or None
        if apart:  # such as an alpha_v of its own
            given["anisotropic"] = True
    changed = {name: value for name, value in given.items() if value != getattr(USUAL, name)}
    return {"loss": state["fit.loss"]} | changed


def was_made_with(fit: Fit, measured: Measured, how: dict[str, Any]) -> bool:
    """Return whether a fit is the one of a material with the arguments of `to_fit_arguments`."""
    usual = "anisotropic", measured.anisotropic
    given = {name: value for name, value in how.items() if (name, value) != usual}
    same = find_repeated_arguments(fit, measured.anisotropic) == given
    return same and fit.checksum == measured.checksum


def find_repeated_arguments(fit: Fit, anisotropic: bool) -> dict[str, Any] | None:
    """Return the arguments of `brdfkit.fit` with which a fit was made, without usual ones.

    `anisotropic`: whether the material is. None for a fit with settings that a script cannot name.
    """
    settings = fit.settings
    if settings.get("solver") or settings.get("constraints") or settings.get("spectral"):
        return None
    given = {name: settings[name] for name in REPEATED if settings.get(name) not in (None, {})}
    changed = {name: value for name, value in given.items() if value != getattr(USUAL, name)}
    if settings.get("anisotropic", anisotropic) != anisotropic:
        changed["anisotropic"] = settings["anisotropic"]
    return {"loss": fit.loss_name} | changed
