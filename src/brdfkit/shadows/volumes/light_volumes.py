"""`LightVolumes`: all shadow volumes of one light, which tell whether a visible point is lit."""

import math
from collections.abc import Iterable
from dataclasses import replace
from typing import Any

import drjit as dr
import numpy as np

from brdfkit.core.array_types import JitFloat, JitInt, JitMask, JitVector
from brdfkit.core.projective.camera import Camera
from brdfkit.core.projective.homogeneous import transform
from brdfkit.core.projective.light import Light
from brdfkit.mitsuba_bridge.surface_points import clearance
from brdfkit.shadows.volumes.mesh import Mesh
from brdfkit.shadows.volumes.projected_faces import ProjectedFaces, picture_matrix, project_faces
from brdfkit.shadows.volumes.stencil import Stencil
from brdfkit.shadows.volumes.volume import Faces, Volume, make_shadow_volume

METHODS = ("depth_fail", "depth_pass")
FAR_PLANES = ("infinite", "finite")
TILE_SIDE = 4  # approximate side of the picture's tiles, which have a list of faces each [pixels]
# Smallest cosine to assume between a camera ray and a normal, as a point that is moved off its
# surface along a grazing ray would move too far
LEAST_COSINE = 1e-3
CAP_DEPTH = 1.0  # inverse depth of the near plane in the projection that `project_near_cap` makes


class LightVolumes:
    """The shadow of meshes in one light, by counting faces of shadow volumes along camera rays.

    meshes : the meshes that cast the shadow.
    light : the light.
    camera : the camera that sees the points to shade.
    method : `depth_pass` counts the walls between the camera and a point, `depth_fail` the walls
        and caps behind the point.
    far_plane : `infinite`, or `finite`: faces beyond the camera's far plane do not count.
    pixels : number of pixels along the longer side of the picture; it determines the tiles' size.
    near_cap : whether the camera may be in a shadow; `depth_pass` then also counts the volumes
        that contain the start of a camera ray, at the near plane.
    volume : named arguments of `make_shadow_volume`.
    """

    def __init__(
        self,
        meshes: Iterable[Mesh],
        light: Light,
        camera: Camera,
        method: str = "depth_fail",
        far_plane: str = "infinite",
        pixels: int = 256,
        near_cap: bool = False,
        **volume: Any,
    ) -> None:
        import mitsuba as mi

        self.volumes = [make_shadow_volume(mesh, light, **volume) for mesh in meshes]
        self.method, self.far_plane = method, far_plane
        kinds = ("walls",) if method == "depth_pass" else ("walls", "front", "back")
        faces = [getattr(volume, kind) for volume in self.volumes for kind in kinds]
        to_picture = picture_matrix(camera)
        halvings = max(round(math.log2(max(pixels / TILE_SIDE, 1))), 0)
        self.stencil = Stencil(project_faces(Faces.join(faces), to_picture), halvings)
        self.to_picture = mi.Matrix4f(to_picture)
        capped = self.volumes if near_cap else []
        self.cap = Stencil(project_near_cap(capped, light, camera), halvings)
        self.light: JitVector = mi.Vector4f(light.point)
        self.near, self.far = mi.Float(1 / camera.near), mi.Float(1 / camera.far)
        self.eye = mi.Point3f(camera.position)
        dr.make_opaque(self.to_picture, self.light, self.near, self.far, self.eye)

    def visibility(self, p: JitVector, n: JitVector, active: JitMask = True) -> JitFloat:
        """Return 1 where the light arrives at points `p` of surfaces with normals `n`, else 0."""
        import mitsuba as mi

        return dr.select(
            self.count_volumes_around(self.move_off_surface(p, n), active) == 0, mi.Float(1), 0
        )

    def move_off_surface(self, p: JitVector, n: JitVector) -> JitVector:
        """Return points `p`, moved off their surfaces along camera rays to the side of the light.

        So no cap of a volume, which may lie on the surface, passes through the points. The distance
        from the surface is that at which shadow rays begin.
        """
        import mitsuba as mi

        to_light = self.light.xyz - self.light.w * mi.Vector3f(p)
        distance = dr.norm(p - self.eye)
        step, ray = clearance(p, distance), (p - self.eye) / distance
        slope = dr.dot(n, ray)
        slope = dr.mulsign(dr.maximum(dr.abs(slope), LEAST_COSINE), slope)
        return p + ray * dr.mulsign(step, dr.dot(n, to_light)) / slope

    def count_volumes_around(self, p: JitVector, active: JitMask = True) -> JitInt:
        """Return how many shadow volumes contain each of the points `p`, as `mi.Int32`."""
        import mitsuba as mi

        x, y, depth, _ = transform(self.to_picture, *dr.detach(p))
        ray, inverse_depth = (x / depth, y / depth), 1 / depth
        if self.method == "depth_pass":
            within = self.cap.count_faces(*ray, mi.Float(CAP_DEPTH), mi.Float(dr.inf), active)
            return within + self.stencil.count_faces(*ray, inverse_depth, self.near, active)
        farthest = self.far if self.far_plane == "finite" else mi.Float(-dr.inf)
        return -self.stencil.count_faces(*ray, farthest, inverse_depth, active)


def project_near_cap(volumes: Iterable[Volume], light: Light, camera: Camera) -> ProjectedFaces:
    """Return the casting triangles, projected by the light onto the camera's near plane.

    A camera ray starts on the near plane. The triangles that cover its start, counted like faces in
    the picture, are as many as the volumes that contain it.
    """
    to_picture, n = picture_matrix(camera), camera.near
    *across, l_z, l_w = to_picture @ light.point
    height = l_z - n * l_w
    # A light in the near plane casts no shadows onto the plane, so then there are no triangles
    fronts = [volume.front for volume in volumes if height]
    beta = np.array([0, 0, 1, -n]) / (height or 1)
    alpha = np.array([0, 0, 0, 1]) - l_w * beta
    sideways = (np.eye(4)[:2] - np.outer(across, beta)) / n
    to_light = np.vstack([sideways, alpha, alpha + beta])
    faces = project_faces(Faces.join(fronts), to_light @ to_picture)
    return replace(faces, times=np.abs(faces.times))
