"""Distance field: direct light on surfaces that are given by distances, with soft shadows.

    {"type": "distance_field", "filename": "scene.json"}

renders a field of `brdfkit.distance_fields`, from a file that `field.save` wrote, or, in Python,
`"field": field.to_json()`. The lights are those of the scene: area emitters on spheres, rectangles
and disks, whose shadows are soft, and points, spots and directions, whose are sharp. A bsdf within
the integrator is the material; a bsdf with a name is that of the parts that `field.made_of(NAME)`
names. Textures have u = x and v = y; the tangent of anisotropic materials is the x axis laid onto
the surface, or the z axis where that stands upright.

`shadow` says how the share of a lamp that a point sees is found: by one march along a cone
(`linear`; `base`, `discrete`; `convex`, longer steps in unions of convex solids), which takes all
that is in the way for one half-plane; by 7 of them (`split`), right for several, small and thin
objects; to the middle of the lamp (`hard`); by two formulas that are known from games (`quilez`,
`aaltonen`); by `rays` rays (`monte_carlo`); or not at all (`none`). `direction` A leads from the
surface to the lamp, B back; `epsilon` is the largest error of that share, within the method's idea
of what is in the way.

`shading` = `split`: the BSDF towards the lamp's middle, the radiance, a solid angle (π (r/d)² of a
sphere, A cosθ / d² of other lamps) and the share: no noise. Shiny materials show a large lamp as a
small one then: of rough metal with α = 0.1 beside a lamp with r/d = 0.2 a picture is 9 % too dark,
with r/d = 0.1 2 %; highlights are right within 6 % up to r/d = α/2 (the gallery has the table).
`estimated`: `samples` samples of the lamp, of which the shadow's edge lets some through: highlights
in the lamp's shape, and rectangles and disks instead of the spheres about them. `exact`: a ray to
every sample; `shadow` is not asked. A sky, `constant` or `envmap`, is always sampled so, and by the
bsdf as well.

Derivatives go to all parameters of the field (`mi.traverse` lists them, by the names of
`field.parameters()`), to bsdfs and to lamps, through what is seen, its silhouettes and soft
shadows, where Mitsuba's `prb` has none. Silhouettes are taken ε/2 outside of where they are, with
ε = 2.8 pixels over the root of the samples per pixel. The silhouettes of lamps, and the shadows of
`estimated`, `exact` and the sky, are missing. The derivative of a shadow is that of its exact
minimum, whatever `epsilon` is: finite differences of a picture whose `epsilon` is 0.05 are wrong
instead, at single points by 40 %.

A field whose steps are not safe, or that is not finite, is refused, as far as random walks find out
(`check_steps`); the bound of the Mandelbulb is measured, not proven, so that rays and shadows may
miss some detail of it. There is no light between surfaces; mirrors show the sky, but no lamp; what
passes through a bsdf, as `dielectric` and `mask`, is dark, with a warning; a lamp casts no shadow;
other shapes of Mitsuba's are refused.

[Bálint et al. 2019]; [Wang et al. 2024]
"""

from brdfkit.core.errors import BrdfkitError
from brdfkit.distance_fields import from_json, load
from brdfkit.distance_fields.checking import check_steps
from brdfkit.distance_fields.shading.direct_light import SHADINGS, SHADOWS, DirectLight
from brdfkit.distance_fields.shading.lamps import find_lamps
from brdfkit.distance_fields.shading.parts import differentiable_parameters, match_bsdfs
from brdfkit.distance_fields.shading.silhouettes import find_near_miss
from brdfkit.distance_fields.shading.visible_point import NORMAL_STEP, find_visible_point
from brdfkit.distance_fields.shadows.field import bounding_sphere
from brdfkit.distance_fields.shadows.shadow import DIRECTIONS
from brdfkit.mitsuba_bridge.check_scenes import reference_film
from brdfkit.mitsuba_bridge.properties.conversions import resolve_file
from brdfkit.mitsuba_bridge.properties.declarations import count, declared, plain_number, text, word
from brdfkit.mitsuba_bridge.registration.registering import refuse_scalar

PARAMETERS = {
    "filename": text("", "file of the field, as JSON"),
    "field": text("", "or the field itself, by `field.to_json()`"),
    "shadow": word(SHADOWS, "how shadows are found"),
    "direction": word(DIRECTIONS, "where marches begin"),
    "epsilon": plain_number(0.05, (1e-3, 0.5), "largest error of the share of a lamp"),
    "rays": count(64, (1, 65_536), "rays of monte_carlo"),
    "shading": word(SHADINGS, "how light is summed up"),
    "samples": count(4, (1, 65_536), "samples of a lamp or the sky, each time"),
    "far": plain_number(0.0, (0, 1e9), "where rays end [unit]; 0: by the size of the field"),
    "precision": plain_number(0.0, (0, 1e3), "radius of the thinnest rays [unit]; 0: by the size"),
}
FAR, PRECISION = 1e3, 1e-4  # in radii of a sphere about the field; FAR in units if that is more


def define(mi):
    """The class of `mi.SamplingIntegrator` for the current variant."""
    import drjit as dr

    class DistanceField(declared(mi.SamplingIntegrator, PARAMETERS)):
        def __init__(self, props):
            super().__init__(props)
            self.bsdfs = dict(props.objects())
            self.tree = field_of(self.filename, self.field)
            size = bounding_sphere(self.tree)[1]
            self.far = self.far or FAR * max(size, 1)
            self.precision = self.precision or PRECISION * size
            self.parts = match_bsdfs(self.tree, self.bsdfs, NORMAL_STEP * self.precision)
            self.values = differentiable_parameters(self.tree)
            how = "shadow", "direction", "epsilon", "rays", "shading", "samples", "far"
            self.light = DirectLight(**{name: getattr(self, name) for name in how})
            self.parameters_changed([])

        def traverse(self, callback):
            for name, value in self.values.items():
                callback.put(name, value, mi.ParamFlags.Differentiable)
            for name, bsdf in self.bsdfs.items():
                callback.put(name, bsdf, mi.ParamFlags.Differentiable)

        def parameters_changed(self, keys):
            self.now = self.tree.with_parameters(self.values)
            self.larger = self.parts.grow(self.now)

        def sample(self, scene, sampler, ray, medium=None, active=True):
            refuse_scalar("distance_field")
            # What the camera sees of lamps and the sky
            shown = scene.ray_intersect(mi.Ray3f(ray), active)
            emitter, radiance = shown.emitter(scene), mi.UnpolarizedSpectrum(0)
            if emitter is not None:
                radiance = mi.unpolarized_spectrum(emitter.eval(shown, active))

            # What lies before them
            end = dr.minimum(shown.t, self.far)
            seen = find_visible_point(self.now, ray, end, self.precision, active)
            light = dr.select(seen.found, self.reflected(scene, seen, sampler), radiance)

            # What comes before them as a silhouette moves
            if dr.grad_enabled(self.now.distance(ray(0))):
                end = dr.minimum(seen.si.t, end)
                miss = find_near_miss(self.now, ray, end, self.precision, active)
                with dr.suspend_grad():
                    front = self.reflected(scene, miss.seen, sampler)
                light = miss.add_derivatives(light, front)
            return mi.depolarizer(light), active, []

        def reflected(self, scene, seen, sampler):
            """The light that a `VisiblePoint` sends to the camera."""
            light = mi.UnpolarizedSpectrum(0)
            bsdf = self.parts.bsdf(self.now, self.larger, seen.si.p)
            for lamp in find_lamps(scene):
                light += self.light.reflect_lamp(lamp, seen, bsdf, sampler)
            sky = scene.environment()
            if sky is not None:
                light += self.light.reflect_sky(sky, seen, bsdf, sampler)
            return light

        def to_string(self):
            return f"DistanceField[{self.tree}]"

    return DistanceField


def field_of(filename, field):
    """The field of a file, or of a text; `BrdfkitError` for none, both, and what is no distance."""
    if bool(filename) == bool(field):
        raise BrdfkitError(
            "distance_field: give the field as a filename, or in Python as field.to_json()."
        )
    where = filename or "distance_field: field"
    found = load(resolve_file(filename)) if filename else from_json(field, where)
    try:
        check_steps(found)
    except BrdfkitError as error:
        raise BrdfkitError(f"{where}: {error}") from error
    return found


def example():
    """A plane, for the checks."""
    return {"type": "distance_field", "field": '{"kind": "plane"}'}


def reference():
    """A scene, and the radiance (3,) of each of its pixels: albedo / π · π (r/d)² L.

    A matte ground below a lamp, whose cone nothing is in.
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
        "sensor": {"type": "orthographic", "to_world": camera, "film": reference_film()},
        "lamp": {"type": "sphere", "center": [0, 0, d], "radius": r, "emitter": light},
    }
    return scene, [albedo * (r / d) ** 2 * value for value in radiance]
