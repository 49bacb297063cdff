"""What casts shadows in a scene: the shapes themselves, or convex parts of their meshes."""

from typing import Any

import numpy as np

from brdfkit.core.array_types import JitMask, MitsubaObject
from brdfkit.core.errors import BrdfkitError
from brdfkit.lighting.visibility.decomposition import decompose, weld
from brdfkit.lighting.visibility.hull import Hull
from brdfkit.lighting.visibility.occluders import Occluders
from brdfkit.lighting.visibility.pieces import is_closed


class Casters:
    """The casters of shadows in a scene, found at the first request; it remembers one scene.

    `concavity` and `resolution` are those of `find_occluders`. `convex` says whether the convex
    parts of meshes cast the shadows, rather than the meshes themselves.
    """

    def __init__(self, concavity: float, resolution: int, convex: bool = True) -> None:
        self.concavity, self.resolution, self.convex = concavity, resolution, convex
        self.key: list[tuple[MitsubaObject, int]] | None = None  # of the remembered scene
        self.casters: tuple[Occluders | None, MitsubaObject | None] = None, None

    def find(self, scene: MitsubaObject) -> tuple[Occluders | None, MitsubaObject | None]:
        """Return the `Occluders`, and a `mitsuba.Scene` of the other shapes; each may be None."""
        if self.key != _scene_key(scene):
            if self.convex:
                self.set(scene, *find_occluders(scene, self.concavity, self.resolution))
            else:
                self.set(scene, None, scene)
        return self.casters

    def set(
        self, scene: MitsubaObject, occluders: Occluders | None, others: MitsubaObject | None
    ) -> None:
        """Let `occluders`, and the shapes of the scene `others`, cast the shadows in a scene."""
        self.key, self.casters = _scene_key(scene), (occluders, others)

    def visible(self, scene: MitsubaObject, ray: MitsubaObject, active: JitMask) -> JitMask:
        """Return whether nothing lies between the ray's origin and its `maxt`."""
        import drjit as dr

        occluders, others = self.find(scene)
        if others is not None:
            active = dr.select(others.ray_test(ray, active), False, active)
        if occluders is not None:
            active = dr.select(occluders.blocked(ray, active)[0], False, active)
        return active


def _scene_key(scene: MitsubaObject) -> list[tuple[MitsubaObject, int]]:
    """Return a key that identifies a scene by its shapes.

    A reference to the scene itself, which holds its integrator, would never be freed. References to
    the shapes prevent another scene's shapes from appearing at the addresses of freed ones.
    """
    return [(shape, shape.primitive_count()) for shape in scene.shapes()]


def find_occluders(
    scene: MitsubaObject, concavity: float, resolution: int
) -> tuple[Occluders | None, MitsubaObject | None]:
    """Return the `Occluders` of a scene's meshes, and a `mitsuba.Scene` of its other shapes.

    Each is None where there are none. `concavity` is that of `decompose`, `resolution` that of
    `Occluders`, whose objects have the ids of their shapes. A shape has no parts if it is not a
    mesh (a sphere, an instance), encloses no volume (a ground), or emits light, which its own parts
    would block. Raises `BrdfkitError` for a scene without shapes.
    """
    import mitsuba as mi

    if not scene.shapes():
        raise BrdfkitError("The scene has no shapes; add what should be seen and cast shadows.")
    objects, others = {}, []
    for shape in scene.shapes():
        solid = shape.shape_type() == mi.ShapeType.Mesh and not shape.is_emitter()
        parts = _decompose_mesh(shape, concavity) if solid else []
        if parts:
            objects[shape.id()] = parts
        else:
            others.append(shape)
    return Occluders(objects, resolution) if objects else None, _make_scene(others)


def _decompose_mesh(mesh: MitsubaObject, concavity: float) -> list[Hull]:
    """Return the convex parts of one of Mitsuba's meshes; warn if it is not closed."""
    import mitsuba as mi

    buffers: Any = mi.traverse(mesh)
    points = np.array(buffers["vertex_positions"], float).reshape(-1, 3)
    faces = np.array(buffers["faces"], int).reshape(-1, 3)
    parts = decompose(points, faces, concavity)
    if parts and not is_closed(weld(points, faces)[1]):
        mi.Log(  # type: ignore[operator]  # an object in Mitsuba's stub
            mi.LogLevel.Warn,
            f"{mesh.id()}: the mesh is not closed; its convex parts are those of a mesh without "
            "its holes, or of a thicker one around it.",
        )
    return parts


def _make_scene(shapes: list[MitsubaObject]) -> MitsubaObject | None:
    """Return a `mitsuba.Scene` of `shapes`, None for no shapes."""
    import mitsuba as mi

    if not shapes:
        return None
    numbered = {f"shape_{i}": shape for i, shape in enumerate(shapes)}
    return mi.load_dict({"type": "scene", **numbered}, parallel=False)
