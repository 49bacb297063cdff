"""`Model`: the base class of BRDF models, which are sums of weights times lobes.

    f(wi, wo) = Σ weight_k · lobe_k(wi, wo; shape) + Σ fixed_lobe_l(wi, wo; shape)

The weights are linear, with one number per colour channel; the shape parameters are nonlinear, and
all channels share them. A model is a class in a file of its own. Its parameters are class
attributes, made by `weight` and `shape`, and `lobes` returns one `Lobe` per weight, in their order.
Few models have `fixed_lobes`, which have no weight.

The same lines run in the renderer, where a parameter has one value per ray, and in a fit, where it
is a double with derivatives. So a model uses functions of `dr`, and no Python `if` on values.

A choice that is not a number to fit, such as a form or an order, is an `option`: a plain Python
value. `Model.configured` derives a class for each value of an option. `more_parameters` adds the
parameters that depend on options, and removes declared ones.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from brdfkit.core.discovery.plugin_pages import read_page
from brdfkit.core.documents import Document, Folded, Shown
from brdfkit.core.errors import BrdfkitError
from brdfkit.images.thumbnails import make_thumbnails
from brdfkit.model.declaration import Declaration
from brdfkit.model.evaluation import evaluate_model
from brdfkit.model.lobes import Lobe
from brdfkit.model.pickling import reduce_model
from brdfkit.model.value_table import make_value_table
from brdfkit.model.weights import (
    check_wavelengths,
    format_value,
    read_value,
    to_mitsuba_entries,
    to_rgb_values,
)


class Model(Shown, Declaration):
    """A BRDF model: a material given by the values of a model's parameters.

    Each model is a class derived from this one. The attributes of an object are the values of its
    parameters, and do not change; `parameters` has the default, bounds and meaning of each.

    Parameters
    ----------
    wavelengths : sequence of float, optional
        Wavelengths [nm] of the numbers of a weight. By default weights are linear sRGB.
    **values : float or sequence of float
        Values by the parameters' names; all other parameters have their default. A weight takes one
        number, or one for each of R, G, B, or of the wavelengths.

    Raises
    ------
    BrdfkitError
        For an unknown name, or a value out of bounds.

    Examples
    --------
    >>> ward = models()["ward"](alpha_u=0.1, specular_reflectance=[0.3, 0.2, 0.1])
    >>> ward.alpha_v
    0.1
    """

    wavelengths: tuple[float, ...] = ()

    if TYPE_CHECKING:  # a type checker cannot know the parameters, which are attributes

        def __getattr__(self, name: str) -> Any: ...

    def __init_subclass__(cls) -> None:
        super().__init_subclass__()
        for name in (*cls.parameters, *cls.options):
            if hasattr(Model, name):
                raise BrdfkitError(f"{cls.__name__}: no parameter can be named {name!r}.")

    def __init__(self, *, wavelengths: ArrayLike = (), **values: ArrayLike | None) -> None:
        self.__dict__["wavelengths"] = check_wavelengths(wavelengths, self.type_name())
        for name in values:
            self.parameter(name)
        for name, parameter in self.parameters.items():
            value = values.get(name)
            if value is None and parameter.follows:
                value = getattr(self, parameter.follows)
            elif value is None:
                value = parameter.default
            what = f"{self.type_name()}: {name}"
            value = read_value(value, parameter.linear, self.wavelengths, what)
            if problem := parameter.find_problem(value):
                raise BrdfkitError(f"{what} = {problem}.")
            self.__dict__[name] = value

    def changed(self, **values: ArrayLike | None) -> Self:
        """Return a copy of the model with other values of some parameters.

        Parameters
        ----------
        **values : float or sequence of float
            Values by the parameters' names. A parameter that follows another one, as alpha_v
            follows alpha_u, still does.

        Returns
        -------
        Model
            Another object of the same class.

        Raises
        ------
        BrdfkitError
            For an unknown name, or a value out of bounds.

        Examples
        --------
        >>> models()["ward"](alpha_u=0.1).changed(alpha_u=0.2).alpha_v
        0.2
        """
        given: dict[str, Any] = {**self.free_values, **values}
        return type(self)(wavelengths=self.wavelengths, **given)

    def __setattr__(self, name: str, value: Any) -> None:
        raise BrdfkitError(
            f"{self.type_name()}: a model's values do not change; make another one, such as "
            f"model.changed({name}={value!r})."
        )

    @classmethod
    def determine_parameters(cls, samples: Any) -> dict[str, float]:
        """Return the shape parameters that a fit need not search, with their values by name.

        They follow from the directions of the `samples`, whatever values were measured there. Most
        models have none.
        """
        return {}

    @classmethod
    def bind(cls, values: dict[str, Any]) -> Any:
        """Return the model with values of any type, such as Dr.Jit arrays, without checks.

        `values` are the values of all parameters by name; those that only an anisotropic material
        needs may be missing.
        """
        bound = object.__new__(cls)
        bound.__dict__.update(values)
        for name, parameter in cls.parameters.items():
            if parameter.turns and name not in values:
                other = parameter.follows
                bound.__dict__[name] = bound.__dict__[other] if other else parameter.default
        return bound

    def lobes(self) -> tuple[Lobe, ...]:
        """Return the terms of the model: one lobe per weight, in the order of the weights."""
        raise NotImplementedError(f"{type(self).__name__} should give its lobes")

    def fixed_lobes(self) -> tuple[Lobe, ...]:
        """Return the terms of the model that have no weight, such as a coat's; most have none."""
        return ()

    def terms(self) -> list[tuple[str, Lobe]]:
        """Return pairs of a weight's name and its lobe, for every term with a weight."""
        weights, lobes = self.weights(), self.lobes()
        if len(weights) != len(lobes):
            raise BrdfkitError(
                f"{self.type_name()}: lobes() returns {len(lobes)} lobes for the {len(weights)} "
                f"weights {', '.join(weights)}; it should return one for each."
            )
        return list(zip(weights, lobes, strict=True))

    def drawn_lobes(self) -> list[tuple[int | None, Lobe]]:
        """Return the lobes that a renderer draws, each with the index of its weight, or None.

        A lobe that was made by `add_lobes` is drawn by its parts.
        """
        drawn: list[tuple[int | None, Lobe]] = []
        for index, lobe in enumerate(self.lobes()):
            drawn += [(index, part) for part in lobe.parts or (lobe,)]
        return [*drawn, *((None, lobe) for lobe in self.fixed_lobes())]

    @property
    def values(self) -> dict[str, float | tuple[float, ...]]:
        """The values of all parameters by name: a number, or a tuple of one per channel."""
        return {name: getattr(self, name) for name in self.parameters}

    @property
    def free_values(self) -> dict[str, float | tuple[float, ...]]:
        """The values without those of parameters that follow another one, and equal it."""
        values = self.values
        followed = {name: p.follows for name, p in self.parameters.items() if p.follows}
        return {n: v for n, v in values.items() if n not in followed or v != values[followed[n]]}

    @property
    def arguments(self) -> dict[str, Any]:
        """The keyword arguments of an equal model: its values, and its wavelengths if any."""
        known = {"wavelengths": self.wavelengths} if self.wavelengths else {}
        return {**known, **self.values}

    @property
    def rgb(self) -> Self:
        """The model with its weights converted to linear sRGB, for RGB pictures.

        A colour outside sRGB is clipped to the bounds of the weight. Terms with the square of a
        weight (``oren_nayar``, ``eon``) use the square of its colour, not the colour of its square.
        """
        return type(self)(**to_rgb_values(self)) if self.wavelengths else self

    @property
    def name(self) -> str:
        """The name of the model in pictures and tables: its label."""
        return self.label()

    def eval(self, wi: ArrayLike, wo: ArrayLike) -> NDArray[np.float64]:
        """Compute the BRDF (n, channels) in sr⁻¹ at direction pairs (n, 3), 0 below the surface."""
        return evaluate_model(self, wi, wo)

    def scene_dict(self) -> dict[str, Any]:
        """Return the model as a BSDF for `mitsuba.load_dict`, in the current variant."""
        import mitsuba as mi

        self.make_known()
        entries = {"type": self.type_name(), **self.changed_options()}
        shown = self if self.wavelengths and mi.is_spectral else self.rgb
        return entries | to_mitsuba_entries(shown)

    def __eq__(self, other: object) -> bool:
        return (
            isinstance(other, Model)
            and type(self) is type(other)
            and self.arguments == other.arguments
        )

    def __hash__(self) -> int:
        return hash((type(self), *self.arguments.values()))

    def __reduce__(self) -> Any:
        return reduce_model(self)

    def document(self) -> Document:
        """Return a summary of the model: small pictures, its values and its page."""
        shown = read_page(type(self))
        return Document(
            f"{self.label()}: {shown.sentence}",
            (
                *make_thumbnails(self.name, self.rgb.eval),
                make_value_table(self),
                Folded(f"the page of {self.type_name()}", str(shown)),
            ),
        )

    def __str__(self) -> str:
        return repr(self)

    def __repr__(self) -> str:
        values = ", ".join(
            f"{name}={format_value(value)}" for name, value in self.arguments.items()
        )
        return f"{self.label()}({values})"
