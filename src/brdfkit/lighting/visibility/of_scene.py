"""The occluders of a Mitsuba scene: convex parts of its meshes, and the shapes that have none."""

import numpy as np

from brdfkit.core.errors import BrdfkitError
from brdfkit.lighting.visibility.decomposition import decompose, weld
from brdfkit.lighting.visibility.occluders import Occluders
from brdfkit.lighting.visibility.pieces import is_closed


def occluders_of(scene, concavity, resolution):
    """(`Occluders` of the meshes, a `mitsuba.Scene` of the other shapes); None where none are.

    scene : the `mitsuba.Scene`.
    concavity : see `decompose`.
    resolution : see `Occluders`.

    Raises `BrdfkitError` for a scene without shapes.

    The objects have the ids of their shapes. No parts have what is no mesh (a sphere, an instance),
    encloses no volume (a ground), or gives light, which would stand in its own.
    """
    import mitsuba as mi

    if not scene.shapes():
        raise BrdfkitError("The scene has no shapes; add what should be seen and cast shadows.")
    objects, others = {}, []
    for shape in scene.shapes():
        cut = shape.shape_type() == mi.ShapeType.Mesh and not shape.is_emitter()
        parts = _parts(shape, concavity) if cut else []
        if parts:
            objects[shape.id()] = parts
        else:
            others.append(shape)
    return Occluders(objects, resolution) if objects else None, _scene_of(others)


def _parts(mesh, concavity):
    import mitsuba as mi

    buffers = mi.traverse(mesh)
    points = np.array(buffers["vertex_positions"], float).reshape(-1, 3)
    faces = np.array(buffers["faces"], int).reshape(-1, 3)
    parts = decompose(points, faces, concavity)
    if parts and not is_closed(weld(points, faces)[1]):
        mi.Log(
            mi.LogLevel.Warn,
            f"{mesh.id()}: the mesh is not closed; its convex parts are those of a mesh without "
            "its holes, or of a thicker one around it.",
        )
    return parts


def _scene_of(shapes):
    import mitsuba as mi

    if not shapes:
        return None
    numbered = {f"shape_{i}": shape for i, shape in enumerate(shapes)}
    return mi.load_dict({"type": "scene", **numbered}, parallel=False)
