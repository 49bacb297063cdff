"""What a BRDF model is: weights × lobes.

    f(wi, wo) = Σ weight_k · lobe_k(wi, wo; shape)

The weights are linear and per colour channel, the shape parameters nonlinear and shared by the
channels. A model is a class in a file of its own: its parameters are class attributes, made by
`weight` and `shape`, and `lobes` gives one `Lobe` per weight, in their order.

The same lines run in the renderer, where a parameter is a value per ray, and in a fit, where
it is a double with derivatives. So a model uses `dr.*` and no Python `if` on values.

What is no number to fit, a form or an order, is an `option`: a plain Python value, and another
class for each (`Model.configured`). Where the parameters depend on it, `more_parameters` adds them.
"""

from functools import cache

import numpy as np

from brdfkit.errors import BrdfkitError
from brdfkit.model.lobes import Lobe
from brdfkit.model.parameters import Option, Parameter
from brdfkit.model.parameters import follows as follows
from brdfkit.model.parameters import option as option
from brdfkit.model.parameters import shape as shape
from brdfkit.model.parameters import weight as weight


class Model:
    """A BRDF model with values. Its attributes are the parameters.

    >>> ward = models()["ward"](alpha_u=0.1, specular_reflectance=[0.3, 0.2, 0.1])
    >>> ward.alpha_v
    0.1
    """

    parameters: dict[str, Parameter] = {}  # noqa: RUF012  filled by __init_subclass__
    options: dict[str, Option] = {}  # noqa: RUF012

    def __init_subclass__(cls):
        own = {k: v for k, v in vars(cls).items() if isinstance(v, Parameter | Option)}
        for name in own:
            if hasattr(Model, name):
                raise BrdfkitError(f"{cls.__name__}: no parameter can be named {name!r}.")
        options = {name: o for name, o in own.items() if isinstance(o, Option)}
        for name, declared in options.items():
            setattr(cls, name, declared.default)
        cls.options = {**cls.options, **options}
        declared = {name: p for name, p in own.items() if isinstance(p, Parameter)}
        cls._declared = {**getattr(cls, "_declared", {}), **declared}
        cls.parameters = {**cls._declared, **cls.more_parameters()}

    @classmethod
    def more_parameters(cls) -> dict[str, Parameter]:
        """Parameters by name that depend on the options, which are attributes of `cls`."""
        return {}

    @classmethod
    def configured(cls, **options):
        """The model with other options, a class like this one.

        >>> models()["ashikhmin_shirley"].configured(diffuse="coupled")    # doctest: +SKIP
        """
        for name, given in options.items():
            if name not in cls.options:
                known = ", ".join(cls.options) or "none"
                raise BrdfkitError(f"{cls.type_name()} has no option {name!r}; it has {known}.")
            options[name] = cls.options[name].read(given, f"{cls.type_name()}: {name}")
        changed = {n: v for n, v in options.items() if v != getattr(cls, n)}
        return _configured(cls, tuple(sorted(changed.items()))) if changed else cls

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
        counts = {len(v) for v in self.values.values() if isinstance(v, tuple)} - {1}
        if len(counts) > 1:
            few, many = sorted(counts)[:2]
            raise BrdfkitError(
                f"{self.type_name()}: the weights have {few} and {many} channels; give each one "
                "number, or one per channel."
            )

    @classmethod
    def type_name(cls):
        """The plugin's type: the name of the model's file."""
        return cls.__module__.rpartition(".")[2]

    @classmethod
    def chosen(cls):
        """The options that are not the default, by name."""
        values = {name: getattr(cls, name) for name in cls.options}
        return {name: v for name, v in values.items() if v != cls.options[name].default}

    @classmethod
    def label(cls):
        """The type with the options that are not the default: ``"lafortune:lobe_count=2"``."""
        options = ",".join(f"{name}={value}" for name, value in cls.chosen().items())
        return f"{cls.type_name()}:{options}" if options else cls.type_name()

    @classmethod
    def parameter(cls, name):
        """The parameter of that name, or an error that lists those there are."""
        if name in cls.options:
            raise BrdfkitError(
                f"{cls.type_name()}: {name} is an option; write {cls.type_name()}:{name}=VALUE."
            )
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
        """True where the surface's azimuth may count: a parameter for each of its directions."""
        return any(p.follows for p in cls.parameters.values())

    @classmethod
    def signed(cls):
        """True where a weight may be negative: then the sum is clamped at 0."""
        return any(p.linear and p.bounds[0] < 0 for p in cls.parameters.values())

    @classmethod
    def determined(cls, samples):
        """Shape parameters by name that a fit takes from where was measured, not from a search."""
        return {}

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
        return self.label()

    def eval(self, wi, wo):
        """BRDF (n, channels) in sr⁻¹ of NumPy direction pairs (n, 3); 0 below the surface."""
        from brdfkit.evaluating import evaluate_model

        return evaluate_model(self, wi, wo)

    def scene_dict(self):
        """The dictionary for `mitsuba.load_dict`."""
        from brdfkit.host.properties import scene_dict

        return scene_dict(self)

    def __reduce__(self):
        from brdfkit.model import labels

        return labels.model_with_values, (self.label(), self.values)

    def __repr__(self):
        values = ", ".join(f"{name}={_short(value)}" for name, value in self.values.items())
        return f"{self.label()}({values})"


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


@cache
def _configured(cls, options):
    attributes = dict(options) | {"__module__": cls.__module__, "__doc__": cls.__doc__}
    return type(cls.__name__, (cls,), attributes)
