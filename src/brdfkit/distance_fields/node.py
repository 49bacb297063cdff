"""`Node`, the base class of all distance fields."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import Field, fields, replace
from typing import Any

from brdfkit.core.array_types import ArrayLike, FloatArray, JitFloat, JitVector
from brdfkit.core.errors import BrdfkitError, no_such_error
from brdfkit.distance_fields import parameters as kinds
from brdfkit.distance_fields.boxes import EVERYWHERE, Box
from brdfkit.distance_fields.export.conversions import Conversions
from brdfkit.distance_fields.export.python_code import to_python
from brdfkit.distance_fields.functions import evaluate
from brdfkit.distance_fields.operators import Operators


class Node(Operators, Conversions):
    """A distance field f: negative inside a solid, and at most the distance to its surface.

    A kind of node is a frozen dataclass that is derived from this class and has a method
    `distance(p)`, written with `functions.py`. Operators, files and parameters use its class name.

    A node also knows properties of its field; combinations derive them from their children's.
    `lipschitz` is a bound L on the slope: from x to y, f changes by no more than L ‖x - y‖. So
    f / L never overstates the distance, and rays may step so far.
    `exact_outside` and `exact_inside` say that f is the distance there, not an estimate below it.
    `is_convex` says that f is a convex function, and so every {f ≤ c} a convex set.
    """

    def __init_subclass__(cls) -> None:
        super().__init_subclass__()
        if "distance" in vars(cls):  # else it is only a base class of several kinds
            kinds.register_node_class(cls)

    def __post_init__(self) -> None:
        for f in list_public_fields(self):
            value = kinds.check_value(f"{self.kind}.{f.name}", getattr(self, f.name), f.metadata)
            object.__setattr__(self, f.name, value)
            for child in value if isinstance(value, tuple) else (value,):
                if f.name in ("child", "children") and not isinstance(child, Node):
                    raise BrdfkitError(f"{self.kind}: {child!r} should be a distance field.")

    @property
    def kind(self) -> str:
        """The name of this kind of node."""
        return type(self).__name__

    def distance(self, p: JitVector) -> JitFloat:
        """Return the field at `p` with x, y and z: Dr.Jit arrays of any backend, or numbers."""
        raise NotImplementedError

    def bounds(self, level: float = 0.0) -> Box:
        """Return the corners (low, high) of a box around all points where the field is ≤ `level`.

        They are infinite if no box is known.
        """
        return EVERYWHERE

    @property
    def children(self) -> tuple[Node, ...]:
        """The nodes of which this node is made."""
        child = getattr(self, "child", ())
        return child if isinstance(child, tuple) else (child,)

    @property
    def exact_outside(self) -> Any:
        """True if the field is the exact distance to the surface outside of the solid."""
        return False

    @property
    def exact_inside(self) -> Any:
        """True if the field is the exact, negative distance to the surface inside of the solid."""
        return False

    @property
    def is_convex(self) -> Any:
        """True if the field is a convex function, so that the solid is convex, too."""
        return False

    @property
    def lipschitz(self) -> float:
        """An upper bound on the slope of the field, by default the largest of the children's."""
        return max((child.lipschitz for child in self.children), default=1.0)

    def __call__(self, points: ArrayLike) -> FloatArray:
        """Return the values (n,) of the field at NumPy's `points` (n, 3), in double precision.

        >>> sphere(1)([[0, 0, 3]])
        array([2.])
        """
        return evaluate(self.distance, points)

    def parameters(self) -> dict[str, Any]:
        """Return the values of all parameters by names such as ``union.0.sphere.radius``.

        A parameter is a number, a triple, or the array of a grid's values.
        """
        values = {
            f"{self.kind}.{f.name}": getattr(self, f.name)
            for f in list_public_fields(self)
            if "check" in f.metadata and "fixed" not in f.metadata
        }
        for prefix, child in self._children_by_prefix():
            values |= {f"{prefix}.{name}": value for name, value in child.parameters().items()}
        return values

    def with_parameters(self, values: Mapping[str, Any]) -> Node:
        """Return the same tree with other values of parameters, by their names in `parameters()`.

        Dr.Jit floats carry derivatives through `distance`.
        """
        known = self.parameters()
        for name in values:
            if name not in known:
                raise no_such_error("parameter", name, known)
        return self._replace_parameters(values)

    def _replace_parameters(self, values: Mapping[str, Any]) -> Node:
        """Return the tree with other values of some parameters, whose names are known to exist."""
        own: dict[str, Any] = {
            f.name: values[f"{self.kind}.{f.name}"]
            for f in list_public_fields(self)
            if f"{self.kind}.{f.name}" in values
        }
        children = tuple(
            child._replace_parameters(select_by_prefix(values, prefix))
            for prefix, child in self._children_by_prefix()
        )
        if hasattr(self, "child"):
            own["child"] = children[0]
        elif children:
            own["children"] = children
        changed: Node = replace(self, **own)  # type: ignore[type-var]  # every kind is a dataclass
        return changed

    def _children_by_prefix(self) -> list[tuple[str, Node]]:
        """Return each child with the prefix of its parameters' names."""
        if len(self.children) == 1 and hasattr(self, "child"):
            return [(self.kind, self.children[0])]
        return [(f"{self.kind}.{i}", child) for i, child in enumerate(self.children)]

    def __repr__(self) -> str:
        return to_python(self)


def list_public_fields(node: Any) -> list[Field[Any]]:
    """Return the dataclass fields that define a node; its caches are left out."""
    return [f for f in fields(node) if not f.name.startswith("_")]


def select_by_prefix(values: Mapping[str, Any], prefix: str) -> dict[str, Any]:
    """Return the entries whose names start with a prefix and a dot, which are cut off."""
    return {n[len(prefix) + 1 :]: v for n, v in values.items() if n.startswith(f"{prefix}.")}
