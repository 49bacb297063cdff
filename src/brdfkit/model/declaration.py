"""What the class of a model declares: its parameters, its options and its name."""

import re
from functools import cache

from brdfkit.core.discovery import plugin_files
from brdfkit.core.errors import BrdfkitError, no_such
from brdfkit.model.parameters import Option, Parameter


class Declaration:
    """The part of a `Model` that belongs to the class and not to the values."""

    parameters: dict[str, Parameter] = {}  # noqa: RUF012  filled by __init_subclass__
    options: dict[str, Option] = {}  # noqa: RUF012

    def __init_subclass__(cls):
        own = {k: v for k, v in vars(cls).items() if isinstance(v, Parameter | Option)}
        options = {name: o for name, o in own.items() if isinstance(o, Option)}
        for name, option in options.items():
            setattr(cls, name, option.default)
        cls.options = {**cls.options, **options}
        parameters = {name: p for name, p in own.items() if isinstance(p, Parameter)}
        for name in parameters:  # an attribute is the value that an object has
            delattr(cls, name)
        cls._declared = {**getattr(cls, "_declared", {}), **parameters}
        all_of_them = {**cls._declared, **cls.more_parameters()}
        cls.parameters = {name: p for name, p in all_of_them.items() if p is not None}

    @classmethod
    def more_parameters(cls) -> dict[str, Parameter | None]:
        """The parameters, by name, that depend on the options; those are attributes of `cls`.

        None stands for a declared parameter that is left out.
        """
        return {}

    @classmethod
    def configured(cls, **options):
        """The class of this model with other options, given by name.

        Raises `BrdfkitError` for an option that the model does not have or a value that is none of
        its choices.

        >>> models()["ashikhmin_shirley"].configured(diffuse="coupled")    # doctest: +SKIP
        """
        for name, given in options.items():
            if name not in cls.options:
                raise no_such("option", name, cls.options, cls.type_name())
            options[name] = cls.options[name].read(given, f"{cls.type_name()}: {name}")
        changed = {n: v for n, v in options.items() if v != getattr(cls, n)}
        return _derive(cls, tuple(sorted(changed.items()))) if changed else cls

    @classmethod
    def without_options(cls):
        """The class as it was written, with the default options."""
        return next(base for base in cls.__mro__ if "_chosen" not in vars(base))

    @classmethod
    def is_in_plugin_file(cls):
        """Whether the class was read from a plugin file, brdfkit's or a user's."""
        return cls.__module__.rpartition(".")[0] in plugin_files.PACKAGES_OF_MODELS

    @classmethod
    def make_known(cls):
        """Add a class that is in no plugin file to the models, for Mitsuba and labels to find it.

        Such a class is defined in a notebook or in a module of the user's.
        """
        model, name = cls.without_options(), cls.type_name()
        if not cls.is_in_plugin_file() and _find_source(name) is not model:
            plugin_files.add_plugins(plugin_files.MODELS, {name: model})

    @classmethod
    def type_name(cls):
        """The plugin's type: the name of the model's file, or of the class in snake case."""
        if cls.is_in_plugin_file():
            return cls.__module__.rpartition(".")[2]
        return re.sub(r"(?<=[a-z0-9])(?=[A-Z])|(?<=[A-Z])(?=[A-Z][a-z])", "_", cls.__name__).lower()

    @classmethod
    def changed_options(cls):
        """The options that differ from their defaults, name → value."""
        values = {name: getattr(cls, name) for name in cls.options}
        return {name: v for name, v in values.items() if v != cls.options[name].default}

    @classmethod
    def label(cls):
        """The type with the options that differ from their defaults: "lafortune:lobe_count=2"."""
        options = ",".join(f"{name}={value}" for name, value in cls.changed_options().items())
        return f"{cls.type_name()}:{options}" if options else cls.type_name()

    @classmethod
    def made_of(cls):
        """The unconfigured classes that a pickled model needs: its own, then those of its terms."""
        return (cls.without_options(),)

    @classmethod
    def parameter(cls, name):
        """The `Parameter` of that name; else raises `BrdfkitError`, which proposes the nearest."""
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
        """Names of the nonlinear parameters; those that follow another only if `anisotropic`."""
        return [
            name
            for name, p in cls.parameters.items()
            if not p.linear and (anisotropic or not p.follows)
        ]

    @classmethod
    def is_anisotropic(cls):
        """True where the BRDF may depend on the surface's azimuth: a parameter follows another."""
        return any(p.follows for p in cls.parameters.values())

    @classmethod
    def has_signed_weights(cls):
        """True where a weight may be negative: then the BRDF is clamped at 0."""
        return any(p.linear and p.bounds[0] < 0 for p in cls.parameters.values())


def _find_source(name):
    """The file or class of the model of that name, None where there is none."""
    return plugin_files.find_plugins(plugin_files.MODELS).get(name)


@cache
def _derive(cls, options):
    """The class derived from `cls` with other `options`, ((name, value), ...)."""
    attributes = dict(options) | {"__module__": cls.__module__, "__doc__": cls.__doc__}
    return type(cls.__name__, (cls,), attributes | {"_chosen": options})
