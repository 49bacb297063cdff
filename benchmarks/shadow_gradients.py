"""Compares derivatives of soft shadows in five scenes with finite differences."""

import drjit as dr
from drjit.llvm.ad import Array3f64 as P
from drjit.llvm.ad import Float64 as Float

from brdfkit.distance_fields.shadows import make_light_cone
from brdfkit.distance_fields.shadows.marches import compute_linear_shadow
from brdfkit.distance_fields.shadows.monte_carlo import compute_monte_carlo_shadow
from brdfkit.distance_fields.shadows.split import compute_split_shadow

# First radius of the cone, steps of differences of a method and of the truth, rays of the truth
BALL, STEP, TRUE_STEP, TRUE_RAYS = 0.02, 0.005, 0.05, 20_000


def sphere_distance(p, centre, radius):
    return dr.norm(p - centre) - radius


def box_distance(p, centre, half):
    q = dr.abs(p - centre) - half
    return dr.safe_sqrt(dr.squared_norm(dr.maximum(q, 0))) + dr.minimum(dr.max(q), 0)


def fixed_sphere_distance(p):
    return sphere_distance(p, P(0.35, 0, 2.5), 0.3)


# By name: a parameter's value, and a function from it to (light's centre, its radius, field)
SCENES = {
    "light moves": (0.2, lambda x: (P(x, 0, 6), Float(1), fixed_sphere_distance)),
    "light grows": (1.0, lambda x: (P(0, 0, 6), x, fixed_sphere_distance)),
    "sphere grows": (
        0.27,
        lambda x: (P(0, 0, 6), Float(1), lambda p: sphere_distance(p, P(0.35, 0, 2.5), x)),
    ),
    "box grows": (
        3.1,
        lambda x: (P(0, 0.1, 6), Float(1), lambda p: box_distance(p, P(-3, 0, 3), P(x, 4, 0.6))),
    ),
    "sphere rises": (
        2.8,
        lambda x: (P(0, 0, 6), Float(2), lambda p: sphere_distance(p, P(0.5, 0, x), 0.4)),
    ),
}


def measure_gradients():
    """Return the derivatives of both methods and their finite differences, by scene."""
    found = {}
    for name, (at, scene) in SCENES.items():

        def share(method, x, *settings, scene=scene):
            """Return the visible share of the light at the value `x` of the parameter."""
            light, radius, field = scene(Float(x))
            return method(
                field, make_light_cone(P(0, 0, 0), light, radius, BALL), *settings
            ).visible

        def difference(method, step, *settings, at=at, share=share):
            """Return the derivative of the share by a finite difference."""
            both = (share(method, at + s, *settings)[0] for s in (step, -step))
            return float(next(both) - next(both)) / (2 * step)

        found[name] = {"truth": difference(compute_monte_carlo_shadow, TRUE_STEP, TRUE_RAYS, 1e-5)}
        methods = (
            ("linear", compute_linear_shadow, 1 / 256),
            ("split", compute_split_shadow, 1 / 2000),
        )
        for label, method, epsilon in methods:
            x = Float(at)
            dr.enable_grad(x)
            dr.backward(share(method, x, 1 / 20))
            found[name][label] = float(dr.grad(x)[0])
            found[name][f"{label}, difference"] = difference(method, STEP, epsilon)
    return found
