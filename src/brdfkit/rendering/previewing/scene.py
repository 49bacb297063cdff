"""Makes the scene of a preview: the shape of one of the scenes under another light.

The ground is left out, unless the preview shows shadows.
"""

from functools import cached_property
from pathlib import Path
from typing import Any

from brdfkit.core.array_types import MitsubaObject
from brdfkit.core.errors import BrdfkitError
from brdfkit.rendering.scene_input.environment import replace_light
from brdfkit.rendering.scene_input.loading import find_scene

# Entries of a scene's dictionary that do not belong to the shape that shows the material
SURROUNDINGS = "sensor", "integrator", "sky", "softbox", "ground"


class PreviewShape:
    """The shape of a scene or a mesh, which is loaded once for all pictures.

    Attributes
    ----------
    build : callable
        Function that returns the scene's dictionary for a BSDF and (width, height).
    """

    def __init__(self, scene: str | Path) -> None:
        self.build = find_scene(scene)

    @cached_property
    def casters(self) -> MitsubaObject:
        """The `mitsuba.Scene` that casts shadows: the shape without the ground."""
        import mitsuba as mi

        built = self.build({"type": "diffuse"})
        shape = {"type": "scene"} | {
            key: part for key, part in built.items() if key not in SURROUNDINGS
        }
        return mi.load_dict(shape, parallel=False)


def describe_preview(
    scene: dict[str, Any],
    light: dict[str, Any] | MitsubaObject,
    integrator: dict[str, Any] | MitsubaObject,
    spp: int,
    ground: bool = False,
) -> dict[str, Any]:
    """Return the dictionary of a `scene` under another light, with or without its ground.

    Each pixel is divided into `spp` equal cells with a ray through the middle of each, so nothing
    is random. Raises `BrdfkitError` for a scene without a sky that the light can replace.
    """
    if not isinstance(scene, dict) or "sky" not in scene:
        raise BrdfkitError(
            "A preview shows a shape: name a scene under the sky, such as ball or knot, or a mesh."
        )
    sensor = dict(scene["sensor"])
    sensor["film"] = sensor["film"] | {"rfilter": {"type": "box"}}
    sensor["sampler"] = {"type": "stratified", "jitter": False, "sample_count": spp}
    lit = replace_light(light, scene) | {"sensor": sensor, "integrator": integrator}
    return {key: part for key, part in lit.items() if ground or key != "ground"}
