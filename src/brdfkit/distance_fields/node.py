"""`Node`: a distance field, whose parameters and children are the fields of a dataclass."""

from collections.abc import Mapping
from dataclasses import fields, replace
from typing import Any

from numpy.typing import ArrayLike, NDArray

from brdfkit.core.errors import BrdfkitError, no_such
from brdfkit.distance_fields import parameters as kinds
from brdfkit.distance_fields.boxes import EVERYWHERE
from brdfkit.distance_fields.export.conversions import Conversions
from brdfkit.distance_fields.export.python_code import written
from brdfkit.distance_fields.operators import Operators
from brdfkit.distance_fields.parameters import checked


class Node(Operators, Conversions):
    """A distance field f: negative inside a solid, and never more than the distance to its surface.

    A node that is derived from it is a frozen dataclass with a method `distance(p)`, written with
    `functions.py`. Its name is the one that operators, files and parameters know it by.

    Three things are tracked through every operation. `lipschitz` is a bound L: from x to y, f
    changes by no more than L ‖x - y‖, so that f / L never overstates the distance: a safe step.
    `exact_outside` and `exact_inside` say that f is the distance there, not an estimate below it.
    `is_convex` says that f is a convex function, and so every {f ≤ c} a convex set.
    """

    def __init_subclass__(cls):
        super().__init_subclass__()
        if "distance" in vars(cls):  # the others are what several kinds have in common
            kinds.add(cls)

    def __post_init__(self) -> None:
        for f in public_fields(self):
            value = checked(f"{self.kind}.{f.name}", getattr(self, f.name), f.metadata)
            object.__setattr__(self, f.name, value)
            for child in value if isinstance(value, tuple) else (value,):
                if f.name in ("child", "children") and not isinstance(child, Node):
                    raise BrdfkitError(f"{self.kind}: {child!r} should be a distance field.")

    @property
    def kind(self) -> str:
        """The name of this kind of node."""
        return type(self).__name__

    def distance(self, p: Any) -> Any:
        """f at `p`, anything with x, y and z: arrays of Dr.Jit's of any backend, or numbers."""
        raise NotImplementedError

    def bounds(self, level: float = 0.0) -> tuple[NDArray, NDArray]:
        """The corners (low, high) of a box around {f ≤ level}; endless where none is known."""
        return EVERYWHERE

    @property
    def children(self) -> tuple["Node", ...]:
        """The nodes of which this one is made."""
        found = getattr(self, "child", ())
        return found if isinstance(found, tuple) else (found,)

    @property
    def exact_outside(self) -> Any:
        """True if f, where it is above 0, is the distance to the surface."""
        return False

    @property
    def exact_inside(self) -> Any:
        """True if -f, where f is below 0, is the distance to the surface."""
        return False

    @property
    def is_convex(self) -> Any:
        """True if f is a convex function, so that the solid is convex, too."""
        return False

    @property
    def lipschitz(self) -> float:
        """L: f changes by at most L per unit of length."""
        return max((child.lipschitz for child in self.children), default=1.0)

    def __call__(self, points: ArrayLike) -> NDArray:
        """f (n,) at NumPy's `points` (n, 3), in double precision.

        >>> sphere(1)([[0, 0, 3]])
        array([2.])
        """
        from brdfkit.distance_fields.functions import evaluate

        return evaluate(self.distance, points)

    def parameters(self) -> dict[str, Any]:
        """All parameters by name, as ``union.0.sphere.radius``: numbers, triples, grids' values."""
        found = {
            f"{self.kind}.{f.name}": getattr(self, f.name)
            for f in public_fields(self)
            if "check" in f.metadata and "fixed" not in f.metadata
        }
        for place, child in self._places():
            found |= {f"{place}.{name}": value for name, value in child.parameters().items()}
        return found

    def with_parameters(self, values: Mapping[str, Any]) -> "Node":
        """The same tree with other values of some parameters, by their names in `parameters()`.

        Floats of Dr.Jit's carry derivatives through `distance`.
        """
        known = self.parameters()
        for name in values:
            if name not in known:
                raise no_such("parameter", name, known)
        return self._changed(values)

    def _changed(self, values):
        own = {
            f.name: values[f"{self.kind}.{f.name}"]
            for f in public_fields(self)
            if f"{self.kind}.{f.name}" in values
        }
        children = tuple(child._changed(below(values, place)) for place, child in self._places())
        if hasattr(self, "child"):
            own["child"] = children[0]
        elif children:
            own["children"] = children
        return replace(self, **own)

    def _places(self):
        """Each child, with the start of its parameters' names."""
        if len(self.children) == 1 and hasattr(self, "child"):
            return [(self.kind, self.children[0])]
        return [(f"{self.kind}.{i}", child) for i, child in enumerate(self.children)]

    def __repr__(self) -> str:
        return written(self)


def public_fields(node):
    """The fields of a node that make it, without what it only remembers."""
    return [f for f in fields(node) if not f.name.startswith("_")]


def below(values, place):
    """The `values` whose names start with `place`, by the rest of their names."""
    return {n[len(place) + 1 :]: v for n, v in values.items() if n.startswith(f"{place}.")}
