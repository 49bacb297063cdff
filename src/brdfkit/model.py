"""What a BRDF model is: weights × lobes.

    f(wi, wo) = Σ weight_k · lobe_k(wi, wo; shape)

The weights are linear and per colour channel, the shape parameters nonlinear and shared by the
channels. A model is a class in a file of its own: its parameters are class attributes, made by
`weight` and `shape`, and `lobes` gives one `Lobe` per weight, in their order.

The same lines run in the renderer, where a parameter is a value per ray, and in a fit, where
it is a double with derivatives. So a model uses `dr.*` and no Python `if` on values.
"""

import math
from dataclasses import dataclass

import numpy as np

from brdfkit.errors import BrdfkitError
from brdfkit.lobes import Lobe


@dataclass(frozen=True)
class Parameter:
    """A parameter of a model: its default, its bounds and what it means."""

    default: float | None
    bounds: tuple[float, float]
    meaning: str
    linear: bool = False
    log: bool = False
    follows: str | None = None

    def __post_init__(self):
        if self.log and self.bounds[0] <= 0:
            raise BrdfkitError(f"{self.meaning!r}: log=True needs bounds above 0.")

    def problem_with(self, value):
        """What is wrong with `value` (one number or several), None if it is within the bounds."""
        low, high = self.bounds
        given = np.asarray(value)
        if np.all(np.isfinite(given) & (given >= low) & (given <= high)):
            return None
        limits = f"at least {low:g}" if math.isinf(high) else f"between {low:g} and {high:g}"
        return f"{value} is out of bounds: it should be {limits}"


def weight(default, meaning):
    """A linear parameter: the strength of one lobe, per colour channel, not negative."""
    return Parameter(default, (0.0, math.inf), meaning, linear=True)


def shape(default, bounds, meaning, log=False):
    """A nonlinear parameter within `bounds`; `log` where its magnitude counts, as of a width."""
    return Parameter(default, bounds, meaning, log=log)


def follows(other, parameter, meaning):
    """A shape parameter that equals the one named `other` unless given: anisotropy."""
    return Parameter(None, parameter.bounds, meaning, log=parameter.log, follows=other)


class Model:
    """A BRDF model with values. Its attributes are the parameters.

    >>> ward = models()["ward"](alpha_u=0.1, specular_reflectance=[0.3, 0.2, 0.1])
    >>> ward.alpha_v
    0.1
    """

    parameters: dict[str, Parameter] = {}  # noqa: RUF012  filled by __init_subclass__

    def __init_subclass__(cls):
        own = {k: v for k, v in vars(cls).items() if isinstance(v, Parameter)}
        for name in own:
            if hasattr(Model, name):
                raise BrdfkitError(f"{cls.__name__}: no parameter can be named {name!r}.")
        cls.parameters = {**cls.parameters, **own}

    def __init__(self, **values):
        """Values by name; what is not given has its default. Weights: one number or one per
        channel. Raises `BrdfkitError` for an unknown name or a value out of bounds."""
        for name in values:
            self.parameter(name)
        for name, parameter in self.parameters.items():
            value = values.get(name)
            if value is None and parameter.follows:
                value = getattr(self, parameter.follows)
            elif value is None:
                value = parameter.default
            value = _number(value, parameter.linear, f"{self.type_name()}: {name}")
            if problem := parameter.problem_with(value):
                raise BrdfkitError(f"{self.type_name()}: {name} = {problem}.")
            setattr(self, name, value)

    @classmethod
    def type_name(cls):
        """The plugin's type: the name of the model's file."""
        return cls.__module__.rpartition(".")[2]

    @classmethod
    def parameter(cls, name):
        """The parameter of that name, or an error that lists those there are."""
        if name not in cls.parameters:
            known = ", ".join(cls.parameters)
            raise BrdfkitError(f"{cls.type_name()} has no parameter {name!r}; it has {known}.")
        return cls.parameters[name]

    @classmethod
    def weights(cls):
        """Names of the linear parameters, in the order of the lobes."""
        return [name for name, p in cls.parameters.items() if p.linear]

    @classmethod
    def shapes(cls, anisotropic=False):
        """Names of the nonlinear parameters; those that follow another if `anisotropic`."""
        return [
            name
            for name, p in cls.parameters.items()
            if not p.linear and (anisotropic or not p.follows)
        ]

    @classmethod
    def anisotropic(cls):
        """True for a model with a parameter per surface direction."""
        return any(p.follows for p in cls.parameters.values())

    @classmethod
    def bind(cls, values):
        """The model over `values` of any type (rays, derivatives), nothing checked."""
        bound = object.__new__(cls)
        bound.__dict__.update(values)
        for name, parameter in cls.parameters.items():
            if parameter.follows and name not in values:
                bound.__dict__[name] = bound.__dict__[parameter.follows]
        return bound

    def lobes(self) -> tuple[Lobe, ...]:
        """One lobe per weight, in the order of the weights."""
        raise NotImplementedError(f"{type(self).__name__} should give its lobes")

    def terms(self):
        """(name of the weight, lobe) of every term."""
        weights, lobes = self.weights(), self.lobes()
        if len(weights) != len(lobes):
            raise BrdfkitError(
                f"{self.type_name()}: lobes() gives {len(lobes)} lobes for the {len(weights)} "
                f"weights {', '.join(weights)}; it should give one each."
            )
        return list(zip(weights, lobes, strict=True))

    @property
    def values(self):
        """The parameters' values by name."""
        return {name: getattr(self, name) for name in self.parameters}

    @property
    def free_values(self):
        """`values` without the parameters that follow another one and equal it."""
        values = self.values
        followed = {name: p.follows for name, p in self.parameters.items() if p.follows}
        return {n: v for n, v in values.items() if n not in followed or v != values[followed[n]]}

    @property
    def name(self):
        """What pictures and tables call it."""
        return self.type_name()

    def eval(self, wi, wo):
        """BRDF (n, channels) in sr⁻¹ of NumPy direction pairs (n, 3); 0 below the surface."""
        from brdfkit.evaluating import evaluate_model

        return evaluate_model(self, wi, wo)

    def scene_dict(self):
        """The dictionary for `mitsuba.load_dict`."""
        from brdfkit.bsdf import scene_dict

        return scene_dict(self)

    def __reduce__(self):
        from brdfkit import registry

        return registry.model_with_values, (self.type_name(), self.values)

    def __repr__(self):
        values = ", ".join(f"{name}={_short(value)}" for name, value in self.values.items())
        return f"{self.type_name()}({values})"


def _number(value, per_channel, what):
    try:
        if np.ndim(value) == 0:
            return float(value)
        if per_channel and np.ndim(value) == 1 and len(value) > 0:
            return tuple(float(v) for v in value)
    except (TypeError, ValueError):
        pass
    expected = "a number or one per channel" if per_channel else "a number"
    raise BrdfkitError(f"{what} = {value!r} should be {expected}.")


def _short(value):
    if isinstance(value, tuple):
        return "[" + ", ".join(f"{v:.4g}" for v in value) + "]"
    return f"{value:.4g}"
