# ruff: noqa: I001, for brdfkit comes first: it chooses the LLVM that Mitsuba loads
"""Makes parts that the scenes of `distance_fields.md` share: materials, lamps, camera, ground."""

from brdfkit.distance_fields import plane
import mitsuba as mi


def scene(field, materials, lights, camera, **settings):
    """Return a Mitsuba scene; `materials`: measured materials or colours by part of the field."""
    bsdfs = {part: bsdf(material) for part, material in materials.items()}
    integrator = {"type": "distance_field", "field": field.to_json(), **bsdfs, **settings}
    return {"type": "scene", "integrator": integrator, "sensor": camera, **lights}


def bsdf(material):
    if isinstance(material, str):
        return {"type": "measured_table", "filename": material}
    return {"type": "eon", "diffuse_reflectance": {"type": "rgb", "value": material}}


def camera(origin, target, fov):
    to_world = mi.ScalarTransform4f().look_at(origin, target, [0, 0, 1])
    return {"type": "perspective", "fov": fov, "to_world": to_world}


def bulb(centre, radius, radiance):
    """Return a lamp in the shape of a ball."""
    return {"type": "sphere", "center": centre, "radius": radius, "emitter": emitter(radiance)}


def panel(centre, towards, half, radiance):
    """Return a square lamp, whose edges are 2 `half` long."""
    to_world = mi.ScalarTransform4f().look_at(centre, towards, [0, 0, 1]).scale(half)
    return {"type": "rectangle", "to_world": to_world, "emitter": emitter(radiance)}


def emitter(radiance):
    return {"type": "area", "radiance": {"type": "rgb", "value": radiance}}


def cove(depth):
    """Return a ground that bends up into a wall."""
    return plane() | plane((0, -1, 0)).at(0, depth, 0).k(depth)
