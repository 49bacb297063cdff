"""Distance field: direct light and soft shadows on surfaces that a signed distance function gives.

    {"type": "distance_field", "filename": "scene.json"}

It renders a field of `brdfkit.distance_fields`, from a file that `field.save` wrote, or in Python
from `"field": field.to_json()`. The scene's lights are area emitters on spheres, rectangles and
disks, with soft shadows, and point, spot and directional lights, with sharp shadows. A bsdf within
the integrator is the material of the field; a bsdf with a name is the material of the parts that
`field.made_of(NAME)` names. Textures have u = x and v = y. The tangent of anisotropic materials is
the x axis projected onto the surface, or the z axis where the x axis is normal to the surface.

`shadow` is the method that finds the visible share of a lamp. Most methods march along the cone
from a point to the lamp and treat everything in it as one half-plane: `linear`, `base`, `discrete`,
and `convex`, which takes longer steps in unions of convex solids. `split` marches 7 times, and is
correct for several, small and thin objects. `hard` follows one ray to the lamp's centre, `quilez`
and `aaltonen` are two formulas known from games, `monte_carlo` follows a number of `rays`, and
`none` omits shadows. With `direction` A the march leads from the surface to the lamp, with B back.
`epsilon` is the largest error of the share, within the assumptions of the method.

`shading` is the method that sums up the light of a lamp. `split` has no noise: it multiplies the
BSDF towards the lamp's centre, the radiance, a solid angle (π (r/d)² of a sphere with the radius r
at the distance d, A cosθ / d² of other lamps with the area A) and the visible share. On shiny
materials a large lamp then looks like a small one: rough metal with α = 0.1 is 9 % too dark beside
a lamp with r/d = 0.2, 2 % with r/d = 0.1; highlights are correct within 6 % up to r/d = α/2 (the
gallery has the table). `estimated` draws `samples` points of the lamp and decides by the edge of
the shadow which of them are visible. Highlights then have the lamp's shape, and rectangles and
disks are not replaced by the spheres about them. `exact` follows a ray to every sample and ignores
`shadow`. A sky, `constant` or `envmap`, is always sampled in this way, and by the bsdf as well.

Derivatives flow to all parameters of the field (`mi.traverse` lists them, by the names of
`field.parameters()`), to bsdfs and to lamps, through visible surfaces, their silhouettes and soft
shadows. Mitsuba's `prb` has none of the latter two. Silhouettes are evaluated ε/2 outside of their
true place, where ε is 2.8 pixels divided by the square root of the samples per pixel. Derivatives
do not include the silhouettes of lamps, nor the shadows of `estimated`, `exact` and the sky. The
derivative of a shadow is that of the model, one straight edge, whatever `epsilon` is: for `linear`,
`base`, `hard` and `split`; for `convex` at `epsilon` = 0.05 it is another one at 1 % of the points,
and for `discrete` it is rough. For it, marches go on in nearly dark rays, and shares are up to
`epsilon` nearer to the truth. Differences of pictures with `epsilon` = 0.05 are off by 40 % at
single points.

Random walks test the field before it is used (`check_steps`): it is refused if its values are too
large for safe steps or not finite. The bound of the Mandelbulb is measured, not proven, so that
rays and shadows may miss some detail of it. Limits: there is no light between surfaces; mirrors
show the sky, but no lamp; light that passes through a bsdf, such as `dielectric` and `mask`, is
missing, with a warning; a lamp casts no shadow; other shapes of Mitsuba are refused.

[Bálint et al. 2019]; [Wang et al. 2024]
"""

from collections.abc import Sequence
from typing import Any

from brdfkit.core.array_types import (
    FloatArray,
    JitColour,
    JitFloat,
    JitMask,
    MitsubaModule,
    MitsubaObject,
)
from brdfkit.core.errors import BrdfkitError
from brdfkit.distance_fields import from_json, load
from brdfkit.distance_fields.checking import check_steps
from brdfkit.distance_fields.node import Node
from brdfkit.distance_fields.shading.direct_light import SHADINGS, SHADOWS, DirectLight
from brdfkit.distance_fields.shading.lamps import find_lamps
from brdfkit.distance_fields.shading.parts import make_differentiable_parameters, match_bsdfs
from brdfkit.distance_fields.shading.silhouettes import find_near_miss
from brdfkit.distance_fields.shading.visible_point import (
    NORMAL_STEP,
    VisiblePoint,
    find_visible_point,
)
from brdfkit.distance_fields.shadows.field import bounding_sphere
from brdfkit.distance_fields.shadows.shadow import DIRECTIONS
from brdfkit.mitsuba_bridge.check_scenes import make_film
from brdfkit.mitsuba_bridge.properties.conversions import resolve_file
from brdfkit.mitsuba_bridge.properties.declarations import (
    declare_choice,
    declare_float,
    declare_int,
    declare_text,
    derive_plugin,
)
from brdfkit.mitsuba_bridge.registration.registering import require_vectorised

PARAMETERS = {
    "filename": declare_text("", "file of the field, as JSON"),
    "field": declare_text("", "or the field itself, by `field.to_json()`"),
    "shadow": declare_choice(SHADOWS, "the method that finds shadows"),
    "direction": declare_choice(DIRECTIONS, "where marches start"),
    "epsilon": declare_float(0.05, (1e-3, 0.5), "largest error of the visible share of a lamp"),
    "rays": declare_int(64, (1, 65_536), "rays of monte_carlo"),
    "shading": declare_choice(SHADINGS, "the method that sums up light"),
    "samples": declare_int(4, (1, 65_536), "samples of each lamp and of the sky"),
    "far": declare_float(0.0, (0, 1e9), "length of rays [unit]; 0: by the size of the field"),
    "precision": declare_float(0.0, (0, 1e3), "radius of the thinnest rays [unit]; 0: by the size"),
}
# Defaults of `far` and `precision`, times the radius of a sphere around the field. Small fields
# have a `far` of 1000 units all the same
RAY_LENGTH, PRECISION = 1e3, 1e-4


def define(mi: MitsubaModule) -> type:
    """Return the plugin's class for Mitsuba's current variant: a `mi.SamplingIntegrator`."""
    import drjit as dr

    Base: MitsubaObject = derive_plugin(mi.SamplingIntegrator, PARAMETERS)

    class DistanceField(Base):
        def __init__(self, props: MitsubaObject) -> None:
            super().__init__(props)
            self.bsdfs = dict(props.objects())
            self.tree = read_field(self.filename, self.field)
            size = bounding_sphere(self.tree)[1]
            self.far: float = self.far or RAY_LENGTH * max(size, 1)
            self.precision: float = self.precision or PRECISION * size
            self.parts = match_bsdfs(self.tree, self.bsdfs, NORMAL_STEP * self.precision)
            self.values = make_differentiable_parameters(self.tree)
            settings = "shadow", "direction", "epsilon", "rays", "shading", "samples", "far"
            self.light = DirectLight(**{name: getattr(self, name) for name in settings})
            self.parameters_changed([])

        def traverse(self, callback: MitsubaObject) -> None:
            for name, value in self.values.items():
                callback.put(name, value, mi.ParamFlags.Differentiable)
            for name, bsdf in self.bsdfs.items():
                callback.put(name, bsdf, mi.ParamFlags.Differentiable)

        def parameters_changed(self, keys: Sequence[str]) -> None:
            self.now = self.tree.with_parameters(self.values)
            self.larger = self.parts.grow_each_material(self.now)

        def sample(
            self,
            scene: MitsubaObject,
            sampler: MitsubaObject,
            ray: MitsubaObject,
            medium: MitsubaObject = None,
            active: JitMask = True,
        ) -> tuple[JitColour, JitMask, list[JitFloat]]:
            require_vectorised("distance_field")
            # Find the lamps and the sky that are directly visible
            background = scene.ray_intersect(mi.Ray3f(ray), active)
            emitter, radiance = background.emitter(scene), mi.UnpolarizedSpectrum(0)
            if emitter is not None:
                radiance = mi.unpolarized_spectrum(emitter.eval(background, active))

            # March to the surface of the field in front of them
            end = dr.minimum(background.t, self.far)
            point = find_visible_point(self.now, ray, end, self.precision, active)
            light = dr.select(point.found, self.reflect_light(scene, point, sampler), radiance)

            # A silhouette just beside the ray has derivatives, because its motion may cover the ray
            if dr.grad_enabled(self.now.distance(ray(0))):
                end = dr.minimum(point.si.t, end)
                miss = find_near_miss(self.now, ray, end, self.precision, active)
                with dr.suspend_grad():
                    front = self.reflect_light(scene, miss.seen, sampler)
                light = miss.attach_silhouette_derivatives(light, front)
            return mi.depolarizer(light), active, []

        def reflect_light(
            self, scene: MitsubaObject, point: VisiblePoint, sampler: MitsubaObject
        ) -> JitColour:
            """Return the light of all lamps and the sky that a `VisiblePoint` reflects."""
            light = mi.UnpolarizedSpectrum(0)
            bsdf = self.parts.find_bsdf(self.now, self.larger, point.si.p)
            for lamps in find_lamps(scene):
                light += lamps.sum_up(
                    lambda lamp, sampler: self.light.compute_light_from_lamp(
                        lamp, point, bsdf, sampler
                    ),
                    sampler,
                )
            sky = scene.environment()
            if sky is not None:
                light += self.light.compute_light_from_environment(sky, point, bsdf, sampler)
            return light

        def to_string(self) -> str:
            return f"DistanceField[{self.tree}]"

    return DistanceField


def read_field(filename: str, field: str) -> Node:
    """Read a distance field from the file `filename`, or from the text `field`, which is JSON.

    Raises `BrdfkitError` if both or neither are given, and for a field that is not safe to march
    along, because some of its values exceed the true distance.
    """
    if bool(filename) == bool(field):
        raise BrdfkitError(
            "distance_field: give the field as a filename, or in Python as field.to_json()."
        )
    where = filename or "distance_field: field"
    tree = load(resolve_file(filename)) if filename else from_json(field, where)
    try:
        check_steps(tree)
    except BrdfkitError as error:
        raise BrdfkitError(f"{where}: {error}") from error
    return tree


def example() -> dict[str, Any]:
    """Return an integrator whose field is a plane, to test the plugin."""
    return {"type": "distance_field", "field": '{"kind": "plane"}'}


def reference() -> tuple[dict[str, Any], Sequence[float] | FloatArray]:
    """Return a test scene, and the radiance (3,) that every pixel of its picture should have.

    A spherical lamp with the radiance L and the radius r, at the distance d above a matte ground,
    gives it the radiance albedo · (r/d)² L.
    """
    import mitsuba as mi

    albedo, radiance, r, d = 0.5, [0.9, 0.6, 0.3], 0.5, 2.0
    t = mi.ScalarTransform4f
    camera = t().look_at([0.01, 0, 1], [0.01, 0, 0], [0, 1, 0]).scale(1e-3)
    grey = {"type": "rgb", "value": [albedo] * 3}
    light = {"type": "area", "radiance": {"type": "rgb", "value": radiance}}
    scene = {
        "type": "scene",
        "integrator": {
            **example(),
            "bsdf": {"type": "diffuse", "reflectance": grey},
        },
        "sensor": {"type": "orthographic", "to_world": camera, "film": make_film()},
        "lamp": {"type": "sphere", "center": [0, 0, d], "radius": r, "emitter": light},
    }
    return scene, [albedo * (r / d) ** 2 * value for value in radiance]
