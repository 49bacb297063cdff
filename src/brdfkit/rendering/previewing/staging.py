"""The scene of a preview: a shape under another light, without its ground or with its shadows."""

from functools import cached_property

from brdfkit.core.errors import BrdfkitError
from brdfkit.rendering.scene_input.environment import light_by
from brdfkit.rendering.scene_input.loading import find_scene

AROUND = "sensor", "integrator", "sky", "softbox", "ground"  # what a scene has besides its shape


class Shape:
    """What a scene shows, the name of one or a mesh; read once for all pictures.

    build : the function of the scene, see `find_scene`.
    """

    def __init__(self, scene):
        self.build = find_scene(scene)

    @cached_property
    def casters(self):
        """The `mitsuba.Scene` that casts shadows: without the ground, which only receives them."""
        import mitsuba as mi

        built = self.build({"type": "diffuse"})
        shape = {"type": "scene"} | {key: part for key, part in built.items() if key not in AROUND}
        return mi.load_dict(shape, parallel=False)


def stage(scene, light, integrator, spp, ground=False):
    """The dictionary of a scene under another light, with or without its ground.

    Its rays go through the middles of pixels, or of equal parts of them: nothing is random. Raises
    `BrdfkitError` for a scene that has no sky in whose place the light could be.
    """
    if not isinstance(scene, dict) or "sky" not in scene:
        raise BrdfkitError(
            "A preview shows a shape: name a scene under the sky, such as ball or knot, or a mesh."
        )
    sensor = dict(scene["sensor"])
    sensor["film"] = sensor["film"] | {"rfilter": {"type": "box"}}
    sensor["sampler"] = {"type": "stratified", "jitter": False, "sample_count": spp}
    lit = light_by(light, scene) | {"sensor": sensor, "integrator": integrator}
    return {key: part for key, part in lit.items() if ground or key != "ground"}
