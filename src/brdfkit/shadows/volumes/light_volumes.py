"""All shadow volumes of one light, and whether it arrives at what a camera sees."""

import math
from dataclasses import replace

import drjit as dr
import numpy as np

from brdfkit.core.projective.homogeneous import transform
from brdfkit.mitsuba_bridge.surface_points import clearance
from brdfkit.shadows.volumes.seen_faces import picture_matrix, seen_faces
from brdfkit.shadows.volumes.stencil import Stencil
from brdfkit.shadows.volumes.volume import Faces, shadow_volume

BEFORE = 1.0  # 1/z of the near plane in the picture of the light


def seen_near_cap(volumes, light, camera):
    """The `SeenFaces` of the triangles that cast onto a `Camera`'s near plane, as the `Light` sees
    them through it: by the places of the picture."""
    to_picture, n = picture_matrix(camera), camera.near
    *across, l_z, l_w = to_picture @ light.point
    height = l_z - n * l_w
    fronts = [volume.front for volume in volumes if height]  # a light in the plane darkens none
    beta = np.array([0, 0, 1, -n]) / (height or 1)
    alpha = np.array([0, 0, 0, 1]) - l_w * beta
    sideways = (np.eye(4)[:2] - np.outer(across, beta)) / n
    to_light = np.vstack([sideways, alpha, alpha + beta])
    seen = seen_faces(Faces.joined(fronts), to_light @ to_picture)
    return replace(seen, times=np.abs(seen.times))


METHODS = ("depth_fail", "depth_pass")
FAR_PLANES = ("infinite", "finite")
TILE = 4  # pixels along a side of a tile, about
GRAZING = 1e-3  # the least cosine by which a ray is taken to leave a surface


class LightVolumes:
    """The shadow of meshes in one light, counted in a camera's picture.

    meshes : the `Mesh`es that cast it.
    light : a `Light`.
    camera : the `Camera` that sees the points; the eye and the middle of the picture.
    method : `depth_pass` counts walls before a point, `depth_fail` walls and caps behind it.
    far_plane : `finite`: what is beyond that of the camera is clipped, and does not count.
    pixels : along the longer side of the picture: makes tiles of a useful size.
    near_cap : whether `depth_pass` begins with the volumes that a place of the near plane is in.
    volume : named arguments of `shadow_volume`.
    """

    def __init__(
        self,
        meshes,
        light,
        camera,
        method="depth_fail",
        far_plane="infinite",
        pixels=256,
        near_cap=False,
        **volume,
    ):
        import mitsuba as mi

        self.volumes = [shadow_volume(mesh, light, **volume) for mesh in meshes]
        self.method, self.far_plane = method, far_plane
        kinds = ("walls",) if method == "depth_pass" else ("walls", "front", "back")
        faces = [getattr(volume, kind) for volume in self.volumes for kind in kinds]
        to_picture = picture_matrix(camera)
        halvings = max(round(math.log2(max(pixels / TILE, 1))), 0)
        self.stencil = Stencil(seen_faces(Faces.joined(faces), to_picture), halvings)
        self.to_picture = mi.Matrix4f(to_picture)
        capped = self.volumes if near_cap else []
        self.cap = Stencil(seen_near_cap(capped, light, camera), halvings)
        self.light = mi.Vector4f(light.point)
        self.near, self.far = mi.Float(1 / camera.near), mi.Float(1 / camera.far)
        self.eye = mi.Point3f(camera.position)
        dr.make_opaque(self.to_picture, self.light, self.near, self.far, self.eye)

    def lit(self, p, n, active=True):
        """1 where the light arrives at points `p` of surfaces with normals `n`, else 0."""
        import mitsuba as mi

        return dr.select(self.count(self.off_surface(p, n), active) == 0, mi.Float(1), 0)

    def off_surface(self, p, n):
        """Points `p`, moved along the camera's rays until they are as far from their surfaces, on
        the light's side, as rays of shadow begin: so that no cap lies where it is looked for."""
        import mitsuba as mi

        to_light = self.light.xyz - self.light.w * mi.Vector3f(p)
        distance = dr.norm(p - self.eye)
        step, ray = clearance(p, distance), (p - self.eye) / distance
        slope = dr.dot(n, ray)
        slope = dr.mulsign(dr.maximum(dr.abs(slope), GRAZING), slope)
        return p + ray * dr.mulsign(step, dr.dot(n, to_light)) / slope

    def count(self, p, active=True):
        """How many volumes points `p` are in (`mi.Int32`), as far as the method counts right."""
        import mitsuba as mi

        x, y, depth, _ = transform(self.to_picture, *dr.detach(p))
        ray, inverse_depth = (x / depth, y / depth), 1 / depth
        if self.method == "depth_pass":
            within = self.cap.count(*ray, mi.Float(BEFORE), mi.Float(dr.inf), active)
            return within + self.stencil.count(*ray, inverse_depth, self.near, active)
        farthest = self.far if self.far_plane == "finite" else mi.Float(-dr.inf)
        return -self.stencil.count(*ray, farthest, inverse_depth, active)
