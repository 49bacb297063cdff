"""Renders shadows by stencil volumes and by rays, and counts the pixels in which they differ."""

from dataclasses import replace

import numpy as np
from brdfkit.theses.ergun2008.views import View

from brdfkit.core.projective.camera import Camera
from brdfkit.core.projective.light import Light
from brdfkit.shadows.maps.scenes import SCENES
from brdfkit.shadows.volumes.light_volumes import LightVolumes
from brdfkit.shadows.volumes.mesh import Mesh

SIZE = 128  # pixels along a side of a picture
RAYS = 32  # shadow rays along a side of a pixel, to find the borders of shadows


class ByVolumes:
    """A scene, given as a dictionary, with its shadows by rays and by stencil volumes."""

    def __init__(self, description):
        self.view = View.from_dictionary(description)
        scene = self.view.scene
        self.camera = Camera.from_sensor(scene.sensors()[0])
        self.meshes = [Mesh.from_shape(shape) for shape in scene.shapes()]
        self.exact, self.facing = self.view.seen.exact, self.view.seen.facing

    def compute_lit(self, **how):
        """Return the mask (pixels,) of pixels that the light reaches, by stencil volumes."""
        light = Light.from_emitter(self.view.seen.emitter)
        volumes = LightVolumes(self.meshes, light, self.camera, pixels=SIZE, **how)
        si = self.view.seen.si
        return np.array(volumes.visibility(si.p, si.n)) == 1

    def count_wrong(self, **how):
        """Return how many pixels differ from rays though no border of a shadow crosses them."""
        differ = np.flatnonzero((self.compute_lit(**how) != self.exact) & self.facing)
        return int((~self.is_on_border(differ)).sum())

    def is_on_border(self, pixels):
        """Return whether a shadow's border crosses each of the `pixels` (k,), by many rays."""
        import mitsuba as mi

        if not len(pixels):
            return np.zeros(0, bool)
        seen, sensor = self.view.seen, self.view.scene.sensors()[0]
        within = np.stack(np.meshgrid(*[(np.arange(RAYS) + 0.5) / RAYS] * 2), -1).reshape(-1, 2)
        corner = np.column_stack([pixels % SIZE, pixels // SIZE])
        places = ((corner[:, None] + within) / SIZE).reshape(-1, 2)
        ray, _ = sensor.sample_ray(0.0, 0.5, mi.Point2f(places.T), mi.Point2f(0.5))
        si = self.view.scene.ray_intersect(ray)
        exact = replace(seen, si=si).exact.reshape(len(pixels), -1)
        return np.ptp(exact.astype(int), axis=1) > 0

    def measure_wrong_share(self, **how):
        """Return the share of the pixels facing the light that are wrong."""
        return self.count_wrong(**how) / self.facing.sum()


def make_bricks(**camera):
    """Return the dictionary of view V1's objects without the round ones, with a changed camera."""
    found = SCENES["objects_on_a_ground"]("V1", 1, (SIZE, SIZE))
    found = {
        name: thing
        for name, thing in found.items()
        if name == "type" or thing["type"] not in ("sphere", "cylinder", "disk")
    }
    return found | {"camera": found["camera"] | camera}


def place_eye_in_shadow():
    """Return the dictionary of the bricks with the camera in the middle of the longest shadow."""
    import drjit as dr
    import mitsuba as mi

    view = View.from_dictionary(make_bricks())
    si, towards = view.seen.si, view.seen.light_sample[0].d
    hit = view.scene.ray_intersect(si.spawn_ray(towards))
    length = dr.select(si.is_valid() & (si.p.z < 1e-3) & hit.is_valid(), hit.t, 0)
    longest = int(np.argmax(np.array(length)))
    middle = np.array(si.p + length / 2 * towards).T[longest].tolist()
    eye = mi.ScalarTransform4f().look_at(middle, [0, 0, 0], [0, 0, 1])
    return make_bricks(to_world=eye)
