"""The base class of `Model` with everything that does not need values of the parameters."""

import re
from functools import cache
from typing import Any, ClassVar, Self

from brdfkit.core.discovery import plugin_files
from brdfkit.core.errors import BrdfkitError, no_such_error
from brdfkit.model.parameters import Option, Parameter


class Declaration:
    """The parameters and options that a `Model` class declares, without their values."""

    parameters: ClassVar[dict[str, Parameter]] = {}  # filled by __init_subclass__
    options: ClassVar[dict[str, Option]] = {}
    _declared: ClassVar[dict[str, Parameter]] = {}

    def __init_subclass__(cls) -> None:
        own = {k: v for k, v in vars(cls).items() if isinstance(v, Parameter | Option)}
        options = {name: o for name, o in own.items() if isinstance(o, Option)}
        for name, option in options.items():
            setattr(cls, name, option.default)
        cls.options = {**cls.options, **options}
        parameters = {name: p for name, p in own.items() if isinstance(p, Parameter)}
        for name in parameters:  # attributes of these names will hold the values of objects
            delattr(cls, name)
        cls._declared = {**cls._declared, **parameters}
        every = {**cls._declared, **cls.more_parameters()}
        cls.parameters = {name: p for name, p in every.items() if p is not None}

    @classmethod
    def more_parameters(cls) -> dict[str, Parameter | None]:
        """Return the additional parameters, by name, that the present values of the options bring.

        A model overrides this, and reads its options as attributes of `cls`. None removes a
        parameter that the class declares.
        """
        return {}

    @classmethod
    def configured(cls, **options: Any) -> type[Self]:
        """Return the class of this model with other values of its options, given by name.

        Raises `BrdfkitError` for an option that the model does not have, and for a value that the
        option does not allow.

        >>> models()["ashikhmin_shirley"].configured(diffuse="coupled")    # doctest: +SKIP
        """
        for name, value in options.items():
            if name not in cls.options:
                raise no_such_error("option", name, cls.options, cls.type_name())
            options[name] = cls.options[name].read(value, f"{cls.type_name()}: {name}")
        changed = {n: v for n, v in options.items() if v != getattr(cls, n)}
        base: Any = cls
        return _derive_class(base, tuple(sorted(changed.items()))) if changed else base

    @classmethod
    def without_options(cls) -> type[Any]:
        """Return the model's original class, whose options have their defaults."""
        return next(base for base in cls.__mro__ if "_chosen" not in vars(base))

    @classmethod
    def is_in_plugin_file(cls) -> bool:
        """Return whether a plugin file, of brdfkit or of a user, defines the class."""
        return cls.__module__.rpartition(".")[0] in plugin_files.PACKAGES_OF_MODELS

    @classmethod
    def make_known(cls) -> None:
        """Register a class of a notebook or a user's module, so that it is found by its name."""
        model, name = cls.without_options(), cls.type_name()
        known = plugin_files.find_plugins(plugin_files.MODELS).get(name)
        if not cls.is_in_plugin_file() and known is not model:
            plugin_files.add_plugins(plugin_files.MODELS, {name: model})

    @classmethod
    def type_name(cls) -> str:
        """Return the plugin's type: the name of the model's file, or of the class in snake case."""
        if cls.is_in_plugin_file():
            return cls.__module__.rpartition(".")[2]
        return re.sub(r"(?<=[a-z0-9])(?=[A-Z])|(?<=[A-Z])(?=[A-Z][a-z])", "_", cls.__name__).lower()

    @classmethod
    def changed_options(cls) -> dict[str, Any]:
        """Return the options that differ from their defaults, by name."""
        values = {name: getattr(cls, name) for name in cls.options}
        return {name: v for name, v in values.items() if v != cls.options[name].default}

    @classmethod
    def label(cls) -> str:
        """Return the model's name and its changed options, such as "lafortune:lobe_count=2"."""
        options = ",".join(f"{name}={value}" for name, value in cls.changed_options().items())
        return f"{cls.type_name()}:{options}" if options else cls.type_name()

    @classmethod
    def made_of(cls) -> tuple[Any, ...]:
        """Return the classes that a pickle stores: the model's own, then those that it sums up."""
        return (cls.without_options(),)

    @classmethod
    def parameter(cls, name: str) -> Parameter:
        """Return the `Parameter` with this name; raise `BrdfkitError` if there is none."""
        if name in cls.options:
            raise BrdfkitError(
                f"{cls.type_name()}: {name} is an option; write {cls.type_name()}:{name}=VALUE."
            )
        if name not in cls.parameters:
            raise no_such_error("parameter", name, cls.parameters, cls.type_name())
        return cls.parameters[name]

    @classmethod
    def weights(cls) -> list[str]:
        """Return the names of the linear parameters, in the order of the lobes."""
        return [name for name, p in cls.parameters.items() if p.linear]

    @classmethod
    def shapes(cls, anisotropic: bool = False) -> list[str]:
        """Return the names of the nonlinear parameters.

        Parameters that only an anisotropic material needs, such as alpha_v, which by default equals
        alpha_u, are included only if `anisotropic`.
        """
        return [
            name
            for name, p in cls.parameters.items()
            if not p.linear and (anisotropic or not p.turns)
        ]

    @classmethod
    def is_anisotropic(cls) -> bool:
        """Return whether the BRDF can change as the surface turns about its normal.

        By default this is so if one parameter (alpha_v) follows another one (alpha_u), or an
        `anisotropy` is declared.
        """
        return any(p.turns for p in cls.parameters.values())

    @classmethod
    def has_signed_weights(cls) -> bool:
        """Return whether a weight may be negative, so that the BRDF is clamped at 0."""
        return any(p.linear and p.bounds[0] < 0 for p in cls.parameters.values())


@cache
def _derive_class(cls: Any, options: tuple[tuple[str, Any], ...]) -> type[Any]:
    """Return a subclass of `cls` whose options have the values of ((name, value), ...)."""
    attributes = dict(options) | {"__module__": cls.__module__, "__doc__": cls.__doc__}
    return type(cls.__name__, (cls,), attributes | {"_chosen": options})
