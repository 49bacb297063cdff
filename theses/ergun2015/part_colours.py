"""Renders a mesh's convex parts, each in a colour of its own."""

import colorsys

import numpy as np
from brdfkit.theses.ergun2015.convex_study import SIZE, SPP
from scipy.spatial import ConvexHull

from brdfkit.core.colours import to_srgb
from brdfkit.rendering.scenes._meshes import make_mesh
from brdfkit.rendering.scenes._studio import make_studio

GOLDEN = 0.618034  # of the colour circle between the hues of a part and the next


def render_coloured_parts(study):
    """Render the parts of a `Study` (SIZE, SIZE, 3) in sRGB, in the light of brdfkit's scenes."""
    import mitsuba as mi

    parts = {f"part_{k}": make_part_mesh(hull, k) for k, hull in enumerate(study.convex.hulls)}
    scene = mi.load_dict(make_studio((SIZE, SIZE)) | parts, parallel=False)
    return to_srgb(np.array(mi.render(scene, spp=SPP, seed=0), float)[..., :3])


def make_part_mesh(hull, number):
    """Return the mesh of a convex hull with flat faces, in the colour of its number."""
    points = hull.vertices
    corners = points[ConvexHull(points).simplices]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    outwards = np.sign(np.einsum("ni,ni->n", normals, corners[:, 0] - points.mean(axis=0)))
    normals *= (outwards / np.linalg.norm(normals, axis=1))[:, None]
    colour = colorsys.hsv_to_rgb(number * GOLDEN % 1, 0.6, 0.8)
    bsdf = {"type": "diffuse", "reflectance": {"type": "rgb", "value": list(colour)}}
    faces = np.arange(corners.size // 3).reshape(-1, 3)
    return make_mesh(
        corners.reshape(-1, 3),
        np.repeat(normals, 3, axis=0),
        np.zeros((faces.size, 2)),
        faces,
        {"type": "twosided", "bsdf": bsdf},
    )
