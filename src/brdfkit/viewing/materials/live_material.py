"""`LiveMaterial`: pictures of one material, measured or a model, which change without waiting.

While something moves, a picture is free of noise at once, from the filtered light of an environment
or from a lamp. At rest, a picture is path-traced pass by pass. A model's parameters, the camera and
the light change without a new kernel.
"""

from __future__ import annotations

from brdfkit.core.array_types import AnyArray
from brdfkit.core.jit.threads import in_turn
from brdfkit.materials.resolve import Material
from brdfkit.rendering.scene_input import mesh_file
from brdfkit.rendering.scene_input.loading import find_scene_suffix
from brdfkit.viewing.materials.live_bsdf import LiveBsdf
from brdfkit.viewing.materials.live_light import LiveLights
from brdfkit.viewing.materials.material_scene import Look, MaterialScene, SceneKind
from brdfkit.viewing.recent import Recent

SCENES = 6  # kept at most


class LiveMaterial:
    """A material with the scenes that show it.

    `lights` are those of the view, which several materials share.

    >>> live = LiveMaterial(models()["ward"](), LiveLights())    # doctest: +SKIP
    >>> live.show(live.material.changed(alpha_u=0.1))
    >>> kind = SceneKind("ball", "studio", (256, 256), moving=True)
    >>> picture = live.render(kind, Look(make_studio_camera()))
    """

    def __init__(self, material: Material, lights: LiveLights) -> None:
        self.bsdf, self.lights = LiveBsdf(material), lights
        self.scenes: Recent[SceneKind, MaterialScene] = Recent(SCENES)

    @property
    def material(self) -> Material:
        """The material as it is shown now."""
        return self.bsdf.material

    @in_turn
    def show(self, material: Material) -> bool:
        """Show the same model with other values; return whether any value has changed.

        Raises `BrdfkitError` for another material.
        """
        return self.bsdf.show(material)

    @in_turn
    def render(self, kind: SceneKind, look: Look, seed: int = 0) -> AnyArray:
        """Render a pass: (height, width, 3), linear sRGB.

        Raises `BrdfkitError` for a shape or an environment map that cannot be shown.
        """
        return self.scenes.get(kind, lambda: self._load(kind)).render(look, seed)

    @in_turn
    def find_directions(self, kind: SceneKind, look: Look) -> tuple[AnyArray, AnyArray]:
        """Return the directions to the camera and to the lamp in each pixel."""
        return self.scenes.get(kind, lambda: self._load(kind)).find_directions(look)

    def _load(self, kind: SceneKind) -> MaterialScene:
        """Load the scene of a kind."""
        is_mesh = find_scene_suffix(kind.shape) in mesh_file.SUFFIXES
        bsdf = self.bsdf.both_sides if is_mesh else self.bsdf.front
        return MaterialScene(kind, bsdf, self.lights.get(kind.light))
