"""Distance fields made from a user's own function of points."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any
from weakref import WeakValueDictionary

import drjit as dr
import numpy as np

from brdfkit.core.arguments import to_positive_number
from brdfkit.core.array_types import FloatArray, JitFloat, JitVector
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.jit import double_precision
from brdfkit.distance_fields.boxes import EVERYWHERE, Box
from brdfkit.distance_fields.export.sampling import find_box_to_sample, to_grid
from brdfkit.distance_fields.node import Node

# Name in the JSON of a field → function, so that the integrator finds the function within the same
# process. An entry is deleted with the last field that uses its function.
_FUNCTIONS: WeakValueDictionary[str, Any] = WeakValueDictionary()
EXPECTED = (
    "it should take points p with p.x, p.y and p.z, arrays of Dr.Jit's, and give f there, as "
    "brdfkit.distance_fields.functions and drjit compute it; or take NumPy's points (n, 3) and "
    "give f (n,)"
)


@dataclass(frozen=True, eq=False, repr=False)
class function(Node):
    """The field of a user's function of Dr.Jit arrays, which has no parameters.

    f : the function, or the name under which another field stored the same function.
    lipschitz : the bound L on the function's slope.
    box : the corners (low, high) of a box around the surface, or None.
    """

    f: Any
    lipschitz: float = 1.0
    box: Any = None

    def __post_init__(self) -> None:
        super().__post_init__()
        f = _FUNCTIONS.get(self.f) if isinstance(self.f, str) else self.f
        if f is None:
            raise BrdfkitError(f"{self.f} belongs to another process; make the field anew here.")
        name = self.f if isinstance(self.f, str) else f"{_format_function_name(f)} at {id(f):#x}"
        _FUNCTIONS[name] = f
        object.__setattr__(self, "_function", f)
        object.__setattr__(self, "f", name)
        object.__setattr__(self, "lipschitz", to_positive_number("lipschitz", self.lipschitz))
        if self.box is not None:
            object.__setattr__(self, "box", tuple(tuple(map(float, c)) for c in self.box))

    def distance(self, p: JitVector) -> JitFloat:
        return self._function(p)  # type: ignore[attr-defined]  # `__post_init__` sets it

    def bounds(self, level: float = 0.0) -> Box:
        if self.box is None or level > 0:
            return EVERYWHERE
        low, high = map(np.array, self.box)
        return low, high


def from_function(
    f: Callable[[Any], Any], lipschitz: float = 1.0, bounds: Any = None, resolution: int = 128
) -> Node:
    """Return a field made from a function of points that is negative inside of a solid.

    A function of Dr.Jit arrays becomes the field itself, with derivatives, but cannot be saved. A
    function of NumPy arrays is sampled on a grid, which can be saved.

    Parameters
    ----------
    f : callable
        The function f(p) of points p with p.x, p.y and p.z, arrays of Dr.Jit's, made of arithmetic,
        of `brdfkit.distance_fields.functions` or of drjit's functions; or a function of NumPy's
        points (n, 3).
    lipschitz : float, default 1
        The most that f changes per unit of length: 1 for a distance. Rays step by f over this
        bound; if it is too small, they miss parts of the surface.
    bounds : (low, high), optional
        The corners, three numbers each, of a box around the surface, which a picture then shows.
        A function of NumPy's arrays needs them.
    resolution : int, default 128
        The number of cells of the grid along the longest edge of the box.

    Returns
    -------
    Node
        The field.

    Raises
    ------
    BrdfkitError
        If `f` is no such function, or the box holds no surface.

    Examples
    --------
    >>> from_function(lambda p: dr.sqrt(p.x**2 + p.y**2 + p.z**2) - 1)([[0, 0, 3]])
    array([2.])
    """
    if isinstance(f, Node):
        return f
    if not callable(f):
        raise BrdfkitError(f"{f!r:.60} is not a function; {EXPECTED}.")
    if _takes_drjit_arrays(f):
        return function(f, lipschitz, None if bounds is None else find_box_to_sample(None, bounds))
    _require_numpy_function(f)
    if bounds is None:
        raise BrdfkitError(
            f"{_format_function_name(f)} works on NumPy's arrays, which rays cannot use: make a "
            "grid of it by brdfkit.distance_fields.from_function(f, bounds=(low, high)), or write "
            "it with p.x, p.y and p.z and the functions of drjit."
        )

    def evaluate_points(points: FloatArray) -> FloatArray:
        """Return the function's values (n,) at `points` (n, 3), so that `to_grid` can use it."""
        return np.asarray(f(points), float)

    sampled: Node = to_grid(evaluate_points, resolution, bounds)
    return sampled


def _takes_drjit_arrays(f: Callable[[Any], Any]) -> bool:
    """Return whether f gives a Dr.Jit array, or a number, for points with p.x, p.y and p.z."""
    try:
        value = f(double_precision.to_vector(np.array([[0.1, 0.2, 0.3], [0.3, 0.1, 0.2]])))
    except Exception:  # a function made for NumPy's points may raise anything here
        return False
    return bool(dr.is_array_v(value)) or isinstance(value, float)


def _require_numpy_function(f: Callable[[Any], Any]) -> None:
    """Raise `BrdfkitError` unless f returns numbers (n,) for points (n, 3)."""
    try:
        shape = np.asarray(f(np.array([[0.1, 0.2, 0.3], [0.3, 0.1, 0.2]])), float).shape
    except Exception as error:
        raise BrdfkitError(
            f"{_format_function_name(f)} is not a function of points ({error}); {EXPECTED}."
        ) from error
    if shape != (2,):
        raise BrdfkitError(f"{_format_function_name(f)} gives {shape} for 2 points; {EXPECTED}.")


def _format_function_name(f: Any) -> str:
    """Return the name of a function, or of a callable's type."""
    return getattr(f, "__name__", type(f).__name__)
