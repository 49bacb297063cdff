"""A volume before a camera, in the light of a lamp and a dim sky, for each of the renderers."""

import numpy as np

FOV = 30  # degrees
DISTANCE = 3.95
LAMP, SKY = 3.2, 0.35  # irradiance, radiance


def stage(integrator, size, eye=(0, -1, 0), up=(0, 0, 1), lit=True):
    """A scene of a volume in the cube from -1 to 1, seen from the direction `eye`.

    integrator : its dictionary, in which the volume is.
    size : pixels along both edges.
    lit : whether there are a lamp, to the left above the camera, and a sky that is not seen.
    """
    import mitsuba as mi

    eye, up = (np.array(v, float) / np.linalg.norm(v) for v in (eye, up))
    camera = mi.ScalarTransform4f().look_at((DISTANCE * eye).tolist(), [0, 0, 0], up.tolist())
    film = {"type": "hdrfilm", "width": size, "height": size, "rfilter": {"type": "box"}}
    scene = {
        "type": "scene",
        "integrator": integrator,
        "sensor": {"type": "perspective", "fov": FOV, "to_world": camera, "film": film},
    }
    if lit:
        left = np.cross(up, eye)
        direction = (-eye - 0.9 * up + 0.8 * left).tolist()
        scene["lamp"] = {"type": "directional", "direction": direction, "irradiance": LAMP}
        scene["fill"] = {"type": "directional", "direction": (-eye - left).tolist(),
                         "irradiance": SKY}  # fmt: skip
    return mi.load_dict(scene, parallel=False)
