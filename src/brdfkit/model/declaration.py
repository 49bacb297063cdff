"""What the class of a model declares: parameters and options, and the names that they give it."""

import re
from functools import cache

from brdfkit.errors import BrdfkitError, no_such
from brdfkit.model.parameters import Option, Parameter
from brdfkit.plugins import discovery


class Declared:
    """What is the same for all values of a `Model`: it belongs to the class."""

    parameters: dict[str, Parameter] = {}  # noqa: RUF012  filled by __init_subclass__
    options: dict[str, Option] = {}  # noqa: RUF012

    def __init_subclass__(cls):
        own = {k: v for k, v in vars(cls).items() if isinstance(v, Parameter | Option)}
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
                raise no_such("option", name, cls.options, cls.type_name())
            options[name] = cls.options[name].read(given, f"{cls.type_name()}: {name}")
        changed = {n: v for n, v in options.items() if v != getattr(cls, n)}
        return _configured(cls, tuple(sorted(changed.items()))) if changed else cls

    @classmethod
    def unconfigured(cls):
        """The class as it was written, with the default options."""
        return next(base for base in cls.__mro__ if "_chosen" not in vars(base))

    @classmethod
    def in_plugin_file(cls):
        """Whether the class was read from a plugin file, brdfkit's or a user's."""
        return cls.__module__.rpartition(".")[0] in discovery.PACKAGES_OF_MODELS

    @classmethod
    def make_known(cls):
        """Give a class that lies in no plugin file its name among the models, as one of a cell of a
        notebook or of somebody's module: Mitsuba and labels find it by that."""
        written = cls.unconfigured()
        if not cls.in_plugin_file() and _known(cls.type_name()) is not written:
            discovery.add(discovery.MODELS, {cls.type_name(): written})

    @classmethod
    def type_name(cls):
        """The plugin's type: the name of the model's file, or of the class in snake case."""
        if cls.in_plugin_file():
            return cls.__module__.rpartition(".")[2]
        return re.sub(r"(?<=[a-z0-9])(?=[A-Z])|(?<=[A-Z])(?=[A-Z][a-z])", "_", cls.__name__).lower()

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
    def made_of(cls):
        """The classes, as they were written, that it needs: of a sum those of its terms, too."""
        return (cls.unconfigured(),)

    @classmethod
    def parameter(cls, name):
        """The parameter of that name, or an error that proposes the nearest."""
        if name in cls.options:
            raise BrdfkitError(
                f"{cls.type_name()}: {name} is an option; write {cls.type_name()}:{name}=VALUE."
            )
        if name not in cls.parameters:
            raise no_such("parameter", name, cls.parameters, cls.type_name())
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


def _known(name):
    return discovery.sources(discovery.MODELS).get(name)


@cache
def _configured(cls, options):
    attributes = dict(options) | {"__module__": cls.__module__, "__doc__": cls.__doc__}
    return type(cls.__name__, (cls,), attributes | {"_chosen": options})
