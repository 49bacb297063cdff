"""`soft_shadow`: how much of a round light each point sees between the surfaces of a field."""

from collections.abc import Callable
from typing import Any

import drjit as dr
import numpy as np

from brdfkit.core.arguments import to_whole_number
from brdfkit.core.errors import BrdfkitError, no_such
from brdfkit.distance_fields.shadows.by_name import METHODS, by_name
from brdfkit.distance_fields.shadows.cone import light_cone
from brdfkit.distance_fields.shadows.shadow import DIRECTIONS, Shadow


def soft_shadow(
    field: Callable[[Any], Any],
    point: Any,
    light: Any,
    radius: Any,
    ball: Any,
    *,
    shadow: str = "linear",
    epsilon: float = 1 / 20,
    direction: str = "A",
    rays: int = 64,
) -> Shadow:
    """The share of a spherical light that each point sees, by one march along a cone.

    It is differentiable by the light, its radius, the points and the parameters of the field.

    Parameters
    ----------
    field : callable
        The distance [unit] at points p with arrays p.x, p.y and p.z, negative inside; or an object
        with a method `distance` like that, and `lipschitz`, `is_convex` and `children` if it has.
    point : Dr.Jit points
        Points just off the surfaces [unit], of any backend and precision.
    light : Dr.Jit points
        The centres of the lights [unit].
    radius : float or Dr.Jit array
        The radius of the lights [unit]; 0 for a hard shadow with an edge as wide as `ball`.
    ball : float or Dr.Jit array
        The radius [unit] of a ball about each point that holds no object: half a pixel, say.
    shadow : str, default "linear"
        The method: "linear", "base", "discrete", "convex", "split" (7 cones: right for several,
        small and thin objects), "hard", "quilez", "aaltonen", or "monte_carlo", the truth.
    epsilon : float, default 0.05
        The largest error of the lit share against the method's model of the light, 0 to 0.5.
    direction : str, default "A"
        "A" marches from the surface to the light, "B" from the light to the surface.
    rays : int, default 64
        How many rays "monte_carlo" follows for each point.

    Returns
    -------
    Shadow
        `visible`, the share, and what it was found by.

    Raises
    ------
    BrdfkitError
        If an argument is out of its range, both radii are 0, or the field is not a number.

    Examples
    --------
    >>> from drjit.llvm import Array3f, Float    # doctest: +SKIP
    >>> import drjit as dr    # doctest: +SKIP
    >>> ball = lambda p: dr.norm(p - Array3f(0.35, 0, 2.5)) - 0.3    # doctest: +SKIP
    >>> soft_shadow(ball, Array3f(0), Array3f(0, 0, 6), 1.0, 0.02).visible    # doctest: +SKIP
    [0.573]
    """
    if shadow not in METHODS:
        raise no_such("shadow", shadow, METHODS, "shadow")
    if not (isinstance(epsilon, int | float) and 0 < epsilon <= 0.5):
        raise BrdfkitError(f"epsilon = {epsilon!r} should be a number above 0, at most 0.5.")
    if direction not in DIRECTIONS:
        raise no_such("direction", direction, DIRECTIONS, "direction")
    if not dr.all((radius >= 0) & (ball >= 0) & (radius + ball > 0)):
        raise BrdfkitError(
            "radius and ball should not be negative, nor both 0: a light of radius 0 needs a ball "
            "about the point, half a pixel wide."
        )
    rays = to_whole_number("rays", rays, 1)
    cone = light_cone(point, light, radius, ball)
    found = by_name(shadow, field, cone, epsilon, direction, rays)
    bad = dr.isnan(found.visible)
    if dr.any(bad):
        first = np.flatnonzero(bad)[0]
        raise BrdfkitError(
            f"The distance is not a number somewhere between point {first} and the light; see "
            "that the field is finite everywhere."
        )
    return found
