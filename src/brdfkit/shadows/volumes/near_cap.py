"""The cap of shadow volumes on the near plane, without which depth-pass misses what the plane cuts.

A point q of the near plane is in as many volumes as casting triangles lie between it and the light.
[Ergun 2008, 2.1.7] projects triangles onto the plane, whole silhouettes only. Here the light is the
eye, and the near plane its picture: a point c = α q + β l of space, l the homogeneous light, lies

    α = c_w - β l_w,   β = (c_z - n c_w) / (l_z - n l_w)

and is seen at q's place with 1/z = (α + β)/α, which is above 1 between the light and the plane. So
nothing is clipped, and an eye in a shadow is as good as another [Hornus et al. 2005].
"""

from dataclasses import replace

import numpy as np

from brdfkit.shadows.volumes.seen_faces import picture_matrix, seen_faces
from brdfkit.shadows.volumes.volume import Faces

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
