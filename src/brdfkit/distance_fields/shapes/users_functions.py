"""A function of points, of the user's, as a distance field."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any
from weakref import WeakValueDictionary

import drjit as dr
import numpy as np

from brdfkit.core.arguments import to_positive
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.jit import double_precision
from brdfkit.distance_fields.boxes import EVERYWHERE
from brdfkit.distance_fields.export.sampling import box_around, to_grid
from brdfkit.distance_fields.node import Node

# What a field's JSON names within one process, for the integrator; freed with the last field of it
_FUNCTIONS: WeakValueDictionary[str, Any] = WeakValueDictionary()
SHOULD = (
    "it should take points p with p.x, p.y and p.z, arrays of Dr.Jit's, and give f there, as "
    "brdfkit.distance_fields.functions and drjit compute it; or take NumPy's points (n, 3) and "
    "give f (n,)"
)


@dataclass(frozen=True, eq=False, repr=False)
class function(Node):
    """What `from_function` makes of a function of Dr.Jit's arrays; it has no parameters."""

    f: Any
    lipschitz: float = 1.0
    box: Any = None

    def __post_init__(self):
        super().__post_init__()
        f = _FUNCTIONS.get(self.f) if isinstance(self.f, str) else self.f
        if f is None:
            raise BrdfkitError(f"{self.f} lived in another process; make the field anew there.")
        name = self.f if isinstance(self.f, str) else f"{_name(f)} at {id(f):#x}"
        _FUNCTIONS[name] = f
        object.__setattr__(self, "_function", f)
        object.__setattr__(self, "f", name)
        object.__setattr__(self, "lipschitz", to_positive("lipschitz", self.lipschitz))
        if self.box is not None:
            object.__setattr__(self, "box", tuple(tuple(map(float, c)) for c in self.box))

    def distance(self, p):
        return self._function(p)

    def bounds(self, level=0.0):
        known = self.box is not None and level <= 0
        return tuple(map(np.array, self.box)) if known else EVERYWHERE


def from_function(
    f: Callable[[Any], Any],
    lipschitz: float = 1.0,
    bounds: Any = None,
    resolution: int = 128,
) -> Node:
    """The field of a function of points: what is below 0 is inside.

    A function of Dr.Jit's arrays is the field itself, with derivatives; it cannot be saved. One of
    NumPy's is sampled on a grid, which can.

    Parameters
    ----------
    f : callable
        f(p) of points p with p.x, p.y and p.z, arrays of Dr.Jit's, made of arithmetic, of
        `brdfkit.distance_fields.functions` or of drjit's functions; or of NumPy's points (n, 3).
    lipschitz : float, default 1
        How much f changes per unit of length at most: 1 for a distance. Rays step by f over this;
        where it is too small, they miss parts of the surface.
    bounds : (low, high), optional
        Corners of a box, three numbers each, around the surface, which a picture then shows. A
        function of NumPy's needs it.
    resolution : int, default 128
        Cells of the grid along the longest edge of the box.

    Returns
    -------
    Node
        The field.

    Raises
    ------
    BrdfkitError
        For what is no such function, and a box without a surface.

    Examples
    --------
    >>> from_function(lambda p: dr.sqrt(p.x**2 + p.y**2 + p.z**2) - 1)([[0, 0, 3]])
    array([2.])
    """
    if isinstance(f, Node):
        return f
    if not callable(f):
        raise BrdfkitError(f"{f!r:.60} is no function; {SHOULD}.")
    if _takes_arrays(f):
        return function(f, lipschitz, None if bounds is None else box_around(None, bounds))
    _require_numpy(f)
    if bounds is None:
        raise BrdfkitError(
            f"{_name(f)} works on NumPy's arrays, which rays cannot use: make a grid of it by "
            "brdfkit.distance_fields.from_function(f, bounds=(low, high)), or write it with p.x, "
            "p.y and p.z and the functions of drjit."
        )
    return to_grid(_Sampled(f), resolution, bounds)


class _Sampled:
    """A function of NumPy's points, as `to_grid` asks for it."""

    def __init__(self, f):
        self.f = f

    def __call__(self, points):
        return np.asarray(self.f(points), float)


def _takes_arrays(f):
    """Whether a function of p.x, p.y and p.z gives an array of Dr.Jit's, or a number."""
    try:
        value = f(double_precision.vector(np.array([[0.1, 0.2, 0.3], [0.3, 0.1, 0.2]])))
    except Exception:  # whatever a function of other points may raise
        return False
    return dr.is_array_v(value) or isinstance(value, float)


def _require_numpy(f):
    """Raise `BrdfkitError` unless a function gives numbers (n,) for points (n, 3)."""
    try:
        shape = np.asarray(f(np.array([[0.1, 0.2, 0.3], [0.3, 0.1, 0.2]])), float).shape
    except Exception as error:
        raise BrdfkitError(f"{_name(f)} is no function of points ({error}); {SHOULD}.") from error
    if shape != (2,):
        raise BrdfkitError(f"{_name(f)} gives {shape} for 2 points; {SHOULD}.")


def _name(f):
    return getattr(f, "__name__", type(f).__name__)
