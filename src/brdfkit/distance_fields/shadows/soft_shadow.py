"""`soft_shadow`: the share of a round light that points see between the surfaces of a field."""

from collections.abc import Callable
from importlib import import_module
from typing import Any

import drjit as dr
import numpy as np

from brdfkit.core.arguments import to_number, to_whole_number
from brdfkit.core.array_types import JitFloat, JitVector
from brdfkit.core.errors import BrdfkitError, no_such_error
from brdfkit.distance_fields.shadows.cone import LightCone, make_light_cone
from brdfkit.distance_fields.shadows.marches import (
    compute_convex_shadow,
    compute_hard_shadow,
    compute_linear_shadow,
)
from brdfkit.distance_fields.shadows.monte_carlo import compute_monte_carlo_shadow
from brdfkit.distance_fields.shadows.shadow import DIRECTIONS, Shadow
from brdfkit.distance_fields.shadows.split import compute_split_shadow

WITH_EDGE = "linear", "base", "discrete", "convex", "split"  # methods that find a straight edge
METHODS = (*WITH_EDGE, "hard", "quilez", "aaltonen", "monte_carlo")
MARCHES = {
    "linear": compute_linear_shadow,
    "convex": compute_convex_shadow,
    "split": compute_split_shadow,
    "hard": compute_hard_shadow,
}


def compute_shadow_by_name(
    name: str, field: Any, cone: LightCone, epsilon: float, direction: str, rays: int
) -> Shadow:
    """Return the shadow by the method called `name`, which ignores settings that it does not have.

    Methods that only serve comparison are loaded from the thesis `balint2019`.
    """
    if name == "monte_carlo":
        return compute_monte_carlo_shadow(field, cone, rays)
    if name in MARCHES:
        return MARCHES[name](field, cone, epsilon, direction)
    rivals: Any = import_module("brdfkit.theses.balint2019.rivals")
    settings = (epsilon, direction) if name in WITH_EDGE else ()
    shadow: Shadow = getattr(rivals, name)(field, cone, *settings)
    return shadow


def soft_shadow(
    field: Callable[[Any], Any],
    point: JitVector,
    light: JitVector,
    radius: JitFloat,
    ball: JitFloat,
    *,
    shadow: str = "linear",
    epsilon: float = 1 / 20,
    direction: str = "A",
    rays: int = 64,
) -> Shadow:
    """Compute the share of a spherical light that each point sees, by one march along a cone.

    It is differentiable by the light, its radius, the points and the parameters of the field.

    Parameters
    ----------
    field : callable
        The function of the distance [unit] at points p with arrays p.x, p.y and p.z, negative
        inside; or an object with such a method `distance`, and optionally `lipschitz`, `is_convex`
        and `children`.
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
        small and thin objects), "hard", "quilez", "aaltonen", or "monte_carlo", the reference.
    epsilon : float, default 0.05
        The largest error of the lit share against the method's model of the light, 0 to 0.5.
    direction : str, default "A"
        The direction of the march: "A" from the surface to the light, "B" back.
    rays : int, default 64
        The number of rays that "monte_carlo" follows for each point.

    Returns
    -------
    Shadow
        The visible share of the light, and the ratio from which it was computed.

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
        raise no_such_error("shadow", shadow, METHODS, "shadow")
    epsilon = to_number("epsilon", epsilon, most=0.5, above=0)
    if direction not in DIRECTIONS:
        raise no_such_error("direction", direction, DIRECTIONS, "direction")
    if not dr.all((radius >= 0) & (ball >= 0) & (radius + ball > 0)):
        raise BrdfkitError(
            "radius and ball should not be negative, nor both 0: for a light of radius 0 give a "
            "ball, half a pixel wide."
        )
    rays = to_whole_number("rays", rays, 1)
    cone = make_light_cone(point, light, radius, ball)
    result = compute_shadow_by_name(shadow, field, cone, epsilon, direction, rays)
    bad = dr.isnan(result.visible)
    if dr.any(bad):
        first = np.flatnonzero(bad)[0]
        raise BrdfkitError(
            f"the distance is not a number somewhere between point {first} and the light; make the "
            "field finite everywhere."
        )
    return result
