"""Small scenes with lights of every kind that a shadow map takes, and their exact shadows."""

import drjit as dr
import mitsuba as mi
import numpy as np

from brdfkit.shadows.maps.placement import Placement

LIGHTS = ("directional", "point", "spot")


def placement_of(scene):
    return Placement.from_scene(scene, scene.sensors()[0], scene.emitters()[0])


def light(kind):
    """A light of a kind, or a sun that shines along a direction (x, y, z)."""
    if not isinstance(kind, str):
        return {"type": "directional", "direction": kind}
    to_world = mi.ScalarTransform4f().look_at([-4, 2, 8], [0, 0, 0], [0, 1, 0])
    return {
        "directional": {"type": "directional", "direction": [1, -0.5, -2]},
        "point": {"type": "point", "position": [-4, 2, 8]},
        "spot": {"type": "spot", "cutoff_angle": 35, "beam_width": 34, "to_world": to_world},
    }[kind]


def objects_on_a_ground(kind, size=128):
    """A ball and a turned cube above a ground, in one light of this kind."""
    t = mi.ScalarTransform4f
    turned = t().translate([1.5, 1, 0.6]).rotate([0, 0, 1], 30).scale(0.5)
    film = {"type": "hdrfilm", "width": size, "height": size, "rfilter": {"type": "box"}}
    camera = t().look_at([4, -6, 5], [0, 0, 0.5], [0, 0, 1])
    return mi.load_dict(
        {
            "type": "scene",
            "light": light(kind),
            "camera": {"type": "perspective", "fov": 40, "to_world": camera, "film": film},
            "ground": {"type": "rectangle", "to_world": t().scale(4)},
            "ball": {"type": "sphere", "center": [0, 0, 1], "radius": 0.8},
            "cube": {"type": "cube", "to_world": turned},
        }
    )


def seen_from(scene, size=128, with_gap=False):
    """The surface in the middle of each pixel, where it faces the light, and whether it is lit;
    and, if asked for, how far it is along the ray of light to what shadows it."""
    sensor, emitter = scene.sensors()[0], scene.emitters()[0]
    index = dr.arange(mi.UInt32, size**2)
    pixel = mi.Point2f(
        (mi.Float(index % size) + 0.5) / size, (mi.Float(index // size) + 0.5) / size
    )
    si = scene.ray_intersect(sensor.sample_ray(0.0, 0.5, pixel, mi.Point2f(0.5))[0])
    ds, _ = emitter.sample_direction(si, mi.Point2f(0.5))
    ray = si.spawn_ray(ds.d)
    ray.maxt = ds.dist
    facing = np.array(si.is_valid() & (dr.dot(si.n, ds.d) > 0))
    found = si, facing, np.array(~scene.ray_test(ray))
    return (*found, np.array(scene.ray_intersect(ray).t)) if with_gap else found


def half_plane(kind, size=0.05):
    """A wide sheet, x < 0, that a light shines past onto a ground, straight down; the ground's
    normal; places on it, over the width of the penumbra, and that width.

    size : of the light, a diameter or a tangent.
    """
    t = mi.ScalarTransform4f
    d_b, d_r, wide = 4.0, 6.0, 40.0
    down = {"type": "directional", "direction": [0, 0, -1]}
    lamp = {"type": "point", "position": [0, 0, d_r]}
    camera = t().look_at([0, 0, 1], [0, 0, 0], [0, 1, 0])
    film = {"type": "hdrfilm", "width": 8, "height": 8}
    half = t().translate([-wide / 2, 0, d_r - d_b]).scale(wide / 2)
    scene = mi.load_dict(
        {
            "type": "scene",
            "light": down if kind == "directional" else lamp,
            "camera": {"type": "perspective", "fov": 50, "to_world": camera, "film": film},
            "ground": {"type": "rectangle", "to_world": t().scale(wide)},
            "sheet": {"type": "rectangle", "to_world": half},
        }
    )
    w = size * (d_r - d_b) / (1 if kind == "directional" else d_b)
    return scene, placement_of(scene), np.linspace(-0.9, 0.9, 200), (0, 0, 1), size, w
