"""Mixture: the diffuse term of one model and the highlights of several, fitted and rendered as one.

    f = f_1 + Σ_{j>1} (f_j without its diffuse term)

The option `models` names the models, as in "ggx+ggx" or "lambert+ward+cook_torrance"; such a sum
may stand wherever brdfkit takes the name of a model. The first model gives the diffuse term. The
parameters of the j-th model are named after the model and j, such as ggx_2_alpha_u. It suits metals
and glossy plastics, which two lobes fit better than one; measurements seldom distinguish three.
[Ngan et al. 2005]; [Kurt 2007, eqs. 3.12, 3.30].
"""

from dataclasses import replace
from typing import ClassVar

from brdfkit.core.errors import BrdfkitError
from brdfkit.model import Model, Parameter, labels, option
from brdfkit.model.lobes import Lobe
from brdfkit.model.samples import Samples

# Each lobe starts narrower than the one before by this factor, as equal lobes are a saddle point
NARROWER = 3.0


class Mixture(Model):
    models = option("ggx+ggx", None, "the models, joined by +")
    # What `list_summands` found, which evaluates models: a renderer asks for it again and again
    _summands: ClassVar[list[tuple[str, type[Model], list[str]]]]

    @classmethod
    def label(cls) -> str:
        return cls.models

    @classmethod
    def list_summands(cls) -> list[tuple[str, type[Model], list[str]]]:
        """Return for each model of the sum the prefix of its parameters, its class and its weights.

        The weights are names; the diffuse term is left out for every model but the first.
        """
        if "_summands" not in cls.__dict__:
            cls._summands = cls._find_summands()
        return cls._summands

    @classmethod
    def _find_summands(cls) -> list[tuple[str, type[Model], list[str]]]:
        """Find what `list_summands` returns."""
        named, parts = cls.models.split("+"), []
        if len(named) < 2:
            raise BrdfkitError(
                f"mixture: models = {cls.models} should name two or more models, joined by +, "
                "such as ggx+ward."
            )
        for number, label in enumerate(named, 1):
            model = labels.model(label)
            diffuse = [name for name, lobe in model().terms() if lobe.diffuse]
            if number > 1 and model().fixed_lobes():
                raise BrdfkitError(
                    f"{cls.models}: {label} has terms without a weight and should come first."
                )
            brought = [n for n in model.weights() if number == 1 or n not in diffuse]
            if not brought:
                raise BrdfkitError(
                    f"{cls.models}: {label} is a diffuse term and should come first."
                )
            parts.append((f"{model.type_name()}_{number}_", model, brought))
        return parts

    @classmethod
    def made_of(cls) -> tuple[type[Model], ...]:
        return (Mixture, *(part for _, model, _ in cls.list_summands() for part in model.made_of()))

    @classmethod
    def more_parameters(cls) -> dict[str, Parameter | None]:
        parameters: dict[str, Parameter | None] = {}
        earlier: list[type[Model]] = []
        parts = cls.list_summands()
        for prefix, model, brought in parts:
            for name, parameter in model.parameters.items():
                if parameter.linear and name not in brought:
                    continue
                # A fit starts at these defaults, so the widths of equal models have to differ
                default = parameter.default
                if default is not None and parameter.width:
                    default = default * NARROWER ** (-earlier.count(model) / parameter.width)
                    default = min(max(default, parameter.bounds[0]), parameter.bounds[1])
                elif default is not None and parameter.linear and name != "diffuse_reflectance":
                    default = default / len(parts)
                follows = parameter.follows and prefix + parameter.follows
                own = name if name == "diffuse_reflectance" else prefix + name
                parameters[own] = replace(parameter, default=default, follows=follows)
            earlier.append(model)
        return parameters

    @classmethod
    def determine_parameters(cls, samples: Samples) -> dict[str, float]:
        """Return the shape parameters that need no search, from all models of the sum, by name.

        They follow from the directions of the `samples`, whatever values were measured there.
        """
        return {
            prefix + name: value
            for prefix, model, _ in cls.list_summands()
            for name, value in model.determine_parameters(samples).items()
        }

    def lobes(self) -> tuple[Lobe, ...]:
        lobes = []
        for prefix, model, brought in self.list_summands():
            shapes = {n: getattr(self, prefix + n) for n in model.shapes(anisotropic=True)}
            terms = model.bind(shapes).terms()
            lobes += [lobe for name, lobe in terms if name in brought]
        return tuple(lobes)

    def fixed_lobes(self) -> tuple[Lobe, ...]:
        prefix, model, _ = self.list_summands()[0]
        shapes = {n: getattr(self, prefix + n) for n in model.shapes(anisotropic=True)}
        return model.bind(shapes).fixed_lobes()
