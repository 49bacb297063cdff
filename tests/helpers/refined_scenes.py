"""Scenes of a ball that the tests of `refine` search, and what they expect of the end."""

import numpy as np

from brdfkit.inverse.scenes.problem.parameters import choose_unknowns
from brdfkit.inverse.scenes.problem.scene import load_scene, make_integrator
from brdfkit.inverse.scenes.problem.targets import read_targets
from brdfkit.inverse.scenes.problem.views import Views
from brdfkit.rendering.scenes._meshes import make_grid_mesh
from brdfkit.rendering.scenes.knot import make_knot_tube

SIZE = 20
TRUTH = {
    "alpha_u": 0.35,
    "f0": 0.6,
    "diffuse_reflectance": (0.4, 0.2, 0.1),
    "specular_reflectance": (0.3, 0.35, 0.25),
}
RADIANCE = 12.0


def bsdf_of(model, values):
    """The dictionary of a model's BSDF; tuples are colours."""
    colours = {k: {"type": "rgb", "value": v} for k, v in values.items() if isinstance(v, tuple)}
    return {"type": model, **values, **colours}


TRUTH_BSDF = bsdf_of("ggx", TRUTH)


def corner(mi, values, integrator="path", size=SIZE):
    """A ball before a coloured wall, which throws light back on it."""
    at = mi.ScalarTransform4f
    return {
        "type": "scene",
        "integrator": {"type": integrator, "max_depth": 4},
        "sensor": {
            "type": "perspective",
            "fov": 26,
            "to_world": at().look_at([0, -4, 1.8], [0, 0, 0.7], [0, 0, 1]),
            "film": {
                "type": "hdrfilm",
                "width": size,
                "height": size,
                "pixel_format": "rgb",
                "rfilter": {"type": "box"},
            },
        },
        "floor": {
            "type": "rectangle",
            "to_world": at().scale(3),
            "bsdf": {"type": "diffuse", "reflectance": 0.6},
        },
        "wall": {
            "type": "rectangle",
            "to_world": at().look_at([0, 1.3, 1], [0, 0, 1], [0, 0, 1]).scale(3),
            "bsdf": {"type": "diffuse", "reflectance": {"type": "rgb", "value": [0.7, 0.3, 0.2]}},
        },
        "ball": {
            "type": "sphere",
            "center": [0, 0, 0.7],
            "radius": 0.7,
            "bsdf": bsdf_of("ggx", values),
        },
        "lamp": {
            "type": "rectangle",
            "to_world": at().look_at([0.8, -1.2, 2.5], [0, 0, 0], [0, 1, 0]).scale(0.5),
            "emitter": {"type": "area", "radiance": {"type": "rgb", "value": [RADIANCE] * 3}},
        },
    }


def alone(mi, bsdf, integrator="path", **more):
    """A ball under an even sky, seen by a camera."""
    entries = corner(mi, TRUTH, integrator)
    del entries["wall"], entries["floor"]
    entries["ball"]["bsdf"] = bsdf
    return {**entries, "sky": {"type": "constant", "radiance": 0.5}, **more}


def noisy(mi, scene, spp=512):
    """Its pictures, by all of its cameras, with noise of 1 %."""
    loaded, rng = mi.load_dict(scene), np.random.default_rng(3)
    clean = [
        np.array(mi.render(loaded, sensor=i, spp=spp, seed=40 + i))
        for i in range(len(loaded.sensors()))
    ]
    return [picture * (1 + 0.01 * rng.standard_normal(picture.shape)) for picture in clean]


def require_back(result, truth):
    """That the values are within 3.5 standard errors of the truth, and these below 20 %."""
    for name, known in truth.items():
        error = np.asarray(result.standard_errors[name])
        assert (np.abs(np.asarray(result.values[name]) - known) < 3.5 * error).all(), name
        assert (error < 0.2 * np.abs(known)).all(), name


def views(mi, picture, scene, parameters=None):
    """The `Views` of a scene's dictionary beside one picture."""
    loaded = load_scene(scene, picture.shape[1::-1])
    names = mi.traverse(loaded)
    chosen = choose_unknowns(names, parameters)
    return Views(loaded, make_integrator(loaded), read_targets(picture), names, chosen)


def knot(mi, alpha, diffuse, size=16):
    """A mesh of plastic under a small lamp, whose highlights single samples hit or miss."""
    entries = corner(mi, TRUTH, size=size)
    del entries["wall"], entries["floor"]
    values = {"f0": 0.04, "specular_reflectance": (1.0,) * 3}
    bsdf = bsdf_of("ggx", {"alpha_u": alpha, "diffuse_reflectance": (diffuse,) * 3, **values})
    lamp = {"type": "area", "radiance": 3000.0}
    return {
        **entries,
        "ball": make_grid_mesh(*make_knot_tube(), bsdf),
        "lamp": {"type": "sphere", "center": [1.5, -3, 4], "radius": 0.05, "emitter": lamp},
    }


LAMPS = "point", "spot", "sun", "panel"


def lamps(mi):
    """A lamp of each kind: a point, a spot light, a distant one and a rectangle."""
    at = mi.ScalarTransform4f

    def white(strength):
        return {"type": "rgb", "value": [strength] * 3}

    above = at().look_at([0, -1, 2.8], [0, 0, 0.7], [0, 1, 0]).scale(0.3)
    aside = at().look_at([-1.5, -2, 2.6], [0, 0, 0.6], [0, 0, 1])
    return {
        "point": {"type": "point", "position": [1.2, -2.2, 2.4], "intensity": white(9)},
        "spot": {"type": "spot", "to_world": aside, "intensity": white(14), "cutoff_angle": 30},
        "sun": {"type": "directional", "direction": [0.3, 0.8, -1], "irradiance": white(2)},
        "panel": {
            "type": "rectangle",
            "to_world": above,
            "emitter": {"type": "area", "radiance": white(20)},
        },
    }


def under_lamps(mi, values=TRUTH, size=16, **more):
    """A ball on a floor with the lamps of `lamps`."""
    entries = corner(mi, values, size=size)
    del entries["wall"], entries["lamp"]
    return {**entries, **lamps(mi), **more}


def shoot(mi, scene, burning, sensor=0, spp=512):
    """The picture under some of the lamps alone, with noise of 1 %."""
    lit = {name: entry for name, entry in scene.items() if name not in LAMPS or name in burning}
    if "panel" not in burning:  # which still casts a shadow
        lit["panel"] = {**scene["panel"], "emitter": {"type": "area", "radiance": 0.0}}
    loaded, rng = mi.load_dict(lit), np.random.default_rng(len(burning) + sensor)
    clean = np.array(mi.render(loaded, sensor=sensor, spp=spp, seed=LAMPS.index(burning[0])))
    return clean * (1 + 0.01 * rng.standard_normal(clean.shape))
