"""Casters of shadows in a scene: its shapes themselves, or convex parts of its meshes."""

from typing import Any

import numpy as np

from brdfkit.core.array_types import JitMask, MitsubaObject
from brdfkit.core.errors import BrdfkitError
from brdfkit.lighting.visibility.decomposition import decompose, weld_vertices
from brdfkit.lighting.visibility.hull import Hull
from brdfkit.lighting.visibility.occluders import Occluders
from brdfkit.lighting.visibility.pieces import is_closed


class Casters:
    """A cache of the shadow casters of one scene, which are found at the first request.

    `convex` says whether the convex parts of meshes cast the shadows, rather than the meshes
    themselves. `concavity` and `resolution` are the settings of the parts, see `find_occluders`.
    """

    def __init__(self, concavity: float, resolution: int, convex: bool = True) -> None:
        self.concavity, self.resolution, self.convex = concavity, resolution, convex
        # the scene whose casters are cached
        self.key: list[tuple[MitsubaObject, int]] | None = None
        self.casters: tuple[Occluders | None, MitsubaObject | None] = None, None

    def find_casters(self, scene: MitsubaObject) -> tuple[Occluders | None, MitsubaObject | None]:
        """Return the shadow casters of a scene: convex parts, and a `mi.Scene` of other shapes.

        Each is None if there are none.
        """
        if self.key != _make_scene_key(scene):
            if self.convex:
                self.set_casters(scene, *find_occluders(scene, self.concavity, self.resolution))
            else:
                self.set_casters(scene, None, scene)
        return self.casters

    def set_casters(
        self, scene: MitsubaObject, occluders: Occluders | None, others: MitsubaObject | None
    ) -> None:
        """Set the shadow casters of a scene: `occluders`, and the shapes of the scene `others`."""
        self.key, self.casters = _make_scene_key(scene), (occluders, others)

    def is_visible(self, scene: MitsubaObject, ray: MitsubaObject, active: JitMask) -> JitMask:
        """Return whether no shadow caster lies between a ray's origin and its `maxt`."""
        import drjit as dr

        occluders, others = self.find_casters(scene)
        if others is not None:
            active = dr.select(others.ray_test(ray, active), False, active)
        if occluders is not None:
            active = dr.select(occluders.is_blocked(ray, active)[0], False, active)
        return active


def _make_scene_key(scene: MitsubaObject) -> list[tuple[MitsubaObject, int]]:
    """Return a key that identifies a scene by its shapes, for the cache of shadow casters.

    A reference to the scene itself would be a cycle, which is never freed, since the scene has a
    reference to its integrator. The key keeps the shapes alive, so that no other scene can have
    shapes with the same addresses.
    """
    return [(shape, shape.primitive_count()) for shape in scene.shapes()]


def find_occluders(
    scene: MitsubaObject, concavity: float, resolution: int
) -> tuple[Occluders | None, MitsubaObject | None]:
    """Return the convex parts of a scene's meshes, and a `mi.Scene` of its other shapes.

    Each is None if there are none. `concavity` is the setting of `decompose`, and `resolution` that
    of `Occluders`, whose objects are named by the ids of shapes. A shape has no parts if it is not
    a mesh (a sphere, an instance), encloses no volume (a ground), or emits light, which its own
    parts would block. Raises `BrdfkitError` for a scene without shapes.
    """
    import mitsuba as mi

    if not scene.shapes():
        raise BrdfkitError("The scene has no shapes; add shapes that cast shadows.")
    objects, others = {}, []
    for shape in scene.shapes():
        solid = shape.shape_type() == mi.ShapeType.Mesh and not shape.is_emitter()
        parts = _decompose_mesh(shape, concavity) if solid else []
        if parts:
            objects[shape.id()] = parts
        else:
            others.append(shape)
    return Occluders(objects, resolution) if objects else None, _make_scene_of_shapes(others)


def _decompose_mesh(mesh: MitsubaObject, concavity: float) -> list[Hull]:
    """Cut a mesh of Mitsuba's into convex parts; warn if it is not closed."""
    import mitsuba as mi

    buffers: Any = mi.traverse(mesh)
    points = np.array(buffers["vertex_positions"], float).reshape(-1, 3)
    faces = np.array(buffers["faces"], int).reshape(-1, 3)
    parts = decompose(points, faces, concavity)
    if parts and not is_closed(weld_vertices(points, faces)[1]):
        mi.Log(  # type: ignore[operator]  # Mitsuba's stub declares no function
            mi.LogLevel.Warn,
            f"{mesh.id()}: the mesh is not closed; its holes were closed, or it was replaced by a "
            "thicker mesh around it, before it was cut into convex parts.",
        )
    return parts


def _make_scene_of_shapes(shapes: list[MitsubaObject]) -> MitsubaObject | None:
    """Return a `mi.Scene` of the `shapes` alone, or None if there are none."""
    import mitsuba as mi

    if not shapes:
        return None
    numbered = {f"shape_{i}": shape for i, shape in enumerate(shapes)}
    return mi.load_dict({"type": "scene", **numbered}, parallel=False)
