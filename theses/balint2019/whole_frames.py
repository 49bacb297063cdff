"""Measures times of whole frames, as the thesis printed them: eye rays, shadows and shading."""

from functools import partial

import drjit as dr
from brdfkit.theses.balint2019 import scenes
from brdfkit.theses.balint2019.measuring import measure_in_turns
from brdfkit.theses.balint2019.rivals import aaltonen, quilez
from brdfkit.theses.balint2019.view import shade_points, trace_eye_rays
from drjit.llvm import Array3f, Float

from brdfkit.distance_fields.shadows import make_light_cone
from brdfkit.distance_fields.shadows.marches import compute_convex_shadow, compute_linear_shadow
from brdfkit.distance_fields.shadows.monte_carlo import compute_monte_carlo_shadow
from brdfkit.theses.timing import compare_times

SIZE, TIMES = 160, 11
ROWS = 1080  # of the thesis's pictures, which are in full HD: empty balls are as large as there
SMALL, LARGE = (0.2, 1 / 10), (1.0, 1 / 20)  # radius of the light, and ε, in Figures 6.2 to 6.6
SOLIDS = (0.6, 1 / 20)  # so in Figure 6.16


def render_frame(scene, radius, method):
    """Return the grey pixels of a picture of a `Scene`, whose shadows are by `method`."""
    points, normals, ball, found = trace_eye_rays(scene, SIZE, ROWS)
    light = Array3f(scene.light)
    beside = light + Array3f(0, 0, 2 * radius + 1)  # where the march of other pixels ends at once
    start = dr.select(found, points, beside)
    visible = Float(1)
    if method is not None:
        cone = make_light_cone(start, light, Float(radius), dr.select(found, ball, radius))
        visible = method(scene.field, cone).visible
    return shade_points(light, points, normals, found, visible)


def measure_frames():
    """Return times (turn,) of frames by their label: scene, radius of the light, method."""
    methods = {}

    def add(scene, settings, **calls):
        radius, epsilon = settings
        marches = {"linear": compute_linear_shadow, "convex": compute_convex_shadow}
        calls |= {name: partial(march, epsilon=epsilon) for name, march in marches.items()}
        for name, call in (calls | {"bare": None}).items():
            label = scene.__name__, radius, name
            methods[label] = partial(render_frame, scene(), radius, call)

    few, some, many = (partial(compute_monte_carlo_shadow, rays=n) for n in (3, 64, 512))
    add(scenes.cube, SMALL, few=few, some=some)
    add(scenes.cube, LARGE, many=many)
    add(scenes.three_solids, SOLIDS, quilez=quilez, aaltonen=aaltonen)
    return measure_in_turns(methods, TIMES)


def measure_horizon(epsilon, forms):
    """Return how long frames by `linear` take over those by `forms`, by form and direction."""
    scene, radius = scenes.horizon(), 0.5
    methods = {
        (name, way): partial(
            render_frame, scene, radius, partial(march, epsilon=epsilon, direction=way)
        )
        for name, march in ({"linear": compute_linear_shadow} | forms).items()
        for way in "AB"
    }
    found = measure_in_turns(methods, TIMES)
    return {
        (form, way): compare_times(found["linear", way], found[form, way])
        for form in forms
        for way in "AB"
    }
