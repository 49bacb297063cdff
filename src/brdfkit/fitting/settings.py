"""Checks the settings of a fit, and restores settings and samples of a finished fit."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import Any, TypeAlias

from brdfkit.core.arguments import to_dictionary, to_number, to_number_pair, to_whole_number
from brdfkit.core.array_types import ArrayLike
from brdfkit.core.errors import BrdfkitError, no_such_error
from brdfkit.fitting.target_albedo import find_target_albedo
from brdfkit.materials.measured.selection import select_samples
from brdfkit.materials.resolve import MaterialLike, to_measured
from brdfkit.model import Model, labels
from brdfkit.model.samples.samples import Samples
from brdfkit.regression import Fit, Loss, Picture, to_loss
from brdfkit.regression.refitting import Refit
from brdfkit.regression.robust.reweighting import WEIGHTS
from brdfkit.regression.solvers import AlbedoAtMost, WeightsAtMost
from brdfkit.regression.solvers.settings import (
    require_supported_constraints,
    to_constraints,
    to_plain_data,
    to_solver,
)

ModelLike: TypeAlias = str | Path | type[Model]
LossLike: TypeAlias = str | Loss | Picture | Callable[..., Any]
Constraint: TypeAlias = AlbedoAtMost | WeightsAtMost | Callable[[Model], ArrayLike]
Constraints: TypeAlias = Constraint | Iterable[Constraint]
Bounds: TypeAlias = Mapping[str, tuple[float, float]]
EXTRAPOLATIONS = "guarded", "free"  # what a fit does beyond the measured angles


@dataclass(frozen=True)
class FitSettings:
    """The arguments of `fit` besides the material, the model, the weights and the progress.

    The attributes have the names, meanings and defaults of these arguments. `check_and_convert`
    returns them in the types that the search needs.
    """

    loss: Any = "cbrt"
    robust: str | None = None
    use_standard_error: bool = True
    solver: Any = None
    constraints: Any = None
    starts: int | None = None
    bounds: Any = None
    fixed: Any = None
    anisotropic: bool | None = None
    max_angle: float = 80.0
    spectral: bool = False
    extrapolate: str = "guarded"
    seed: int = 0

    @classmethod
    def from_dictionary(cls, given: Any) -> FitSettings:
        """Return checked settings from the dictionary that a user gave to `sweep` or `report`.

        The loss must be a name, because other processes may fit. Raises `BrdfkitError` for unknown
        names, and for values that `fit` refuses for every model and every material.

        >>> FitSettings.from_dictionary({"loss": "log"}).max_angle
        80.0
        """
        known = [field.name for field in fields(cls)]
        for name in given:
            if name not in known:
                raise no_such_error("setting of a fit", name, known)
        settings = cls(**given)
        if not isinstance(settings.loss, str):
            raise BrdfkitError(
                f"loss = {settings.loss!r} is no name; where other processes fit, it should be one "
                "of brdfkit.losses.named."
            )
        to_loss(settings.loss)
        return settings.check_and_convert()

    def check_and_convert(self, where: str = "") -> FitSettings:
        """Return these settings in the types that the search needs.

        Raises `BrdfkitError` for values that are wrong for every model and material. `where` is put
        before the names of parameters in error messages.
        """
        if self.robust not in (None, *WEIGHTS):
            raise no_such_error("robust weight", self.robust, WEIGHTS)
        if self.extrapolate not in EXTRAPOLATIONS:
            raise no_such_error("extrapolation", self.extrapolate, EXTRAPOLATIONS)
        solver, constraints = to_solver(self.solver), to_constraints(self.constraints)
        require_supported_constraints(solver, constraints, self.robust)
        starts = self.starts
        if starts is not None:
            starts = to_whole_number("starts", starts, least=1)
        seed = to_whole_number("seed", self.seed, least=0)
        bounds = to_dictionary("bounds", self.bounds)
        to_number("max_angle", self.max_angle, above=0, most=90)
        return replace(
            self,
            solver=solver,
            constraints=constraints,
            starts=starts,
            bounds={n: to_number_pair(f"{where}the bounds of {n}", v) for n, v in bounds.items()},
            fixed=to_dictionary("fixed", self.fixed),
            seed=seed,
        )

    def to_search_arguments(self) -> dict[str, Any]:
        """Return the arguments of `regress` that these settings determine, by name."""
        names = "robust", "seed", "starts", "bounds", "fixed", "solver", "constraints"
        return {name: getattr(self, name) for name in (*names, "anisotropic")}

    def to_record(self) -> dict[str, Any]:
        """Return these settings as plain data, for `Fit.settings` and for the file of a fit."""
        return {
            "robust": self.robust,
            "max_angle": float(self.max_angle),
            "use_standard_error": self.use_standard_error,
            "seed": self.seed,
            "starts": self.starts,
            "bounds": self.bounds,
            "fixed": self.fixed,
            "solver": to_plain_data(self.solver),
            "constraints": list(map(to_plain_data, self.constraints)),
            "anisotropic": self.anisotropic,
            "spectral": bool(self.spectral),
            "extrapolate": self.extrapolate,
        }


def prepare_refit(fit: Fit, material: MaterialLike) -> Refit:
    """Return a `Refit`, with which the bootstrap and profiles repeat a fit to `material`."""
    samples = select_fitted_samples(fit, material)
    data = to_measured(material)
    data = data if fit.wavelengths else data.rgb
    target = find_target_albedo(data, None, fit.settings.get("max_angle", 80.0))
    return Refit(fit, samples, target)


def require_material_first(call: str, material: object) -> None:
    """Raise `BrdfkitError` if a model takes the place of the material, as in `fit("ggx", paint)`.

    `call` is the right order of arguments, such as "fit(material, model)", for the message.
    """
    several = material if isinstance(material, list | tuple) else [material]
    if several and all(map(_is_model, several)):
        raise BrdfkitError(
            f"{material!r:.60} is a model, where the measured material belongs: {call}."
        )


def _is_model(given: object) -> bool:
    """Return whether an argument can only be a model: a fit, a model, its class, label or file."""
    if isinstance(given, str | Path):
        is_file = os.path.isfile(given)
        return str(given).endswith(".py") or (not is_file and labels.is_label(str(given)))
    return isinstance(given, Fit | Model) or (isinstance(given, type) and issubclass(given, Model))


def select_fitted_samples(fit: Fit, material: MaterialLike) -> Samples:
    """Return the samples of `material` to which `fit` was fitted.

    They have standard errors only if the fit weighed its samples by these.
    """
    if not isinstance(fit, Fit):
        raise BrdfkitError(
            f"Here a Fit is needed first, then the material, not a {type(fit).__name__}; make one "
            "by fit(material, model)."
        )
    settings, data = fit.settings, to_measured(material)
    errors = settings.get("use_standard_error", False)
    return select_samples(
        data, settings.get("max_angle", 80.0), errors=errors, spectral=bool(fit.wavelengths)
    )


def require_no_sample_settings(**given: object) -> None:
    """Raise `BrdfkitError` for each of the `given` arguments that a fit to pictures cannot use.

    A pixel mixes many samples and wavelengths, so weights of samples, robust weights and spectra
    have no meaning there.
    """
    for name, value in given.items():
        if value is not None and value is not False:
            raise BrdfkitError(
                f"{name} looks at samples one by one, and the loss picture at pixels, which mix "
                f"many; leave {name} out, or choose another loss."
            )
