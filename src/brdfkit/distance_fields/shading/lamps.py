"""The lights of a scene, as spheres: the lit ones themselves, and those about rectangles and disks.

[Bálint et al. 2019, section 5.3]
"""

from dataclasses import dataclass
from typing import Any

import drjit as dr

from brdfkit.core.errors import BrdfkitError

# Mitsuba's shapes that may be lamps: points of their edges, and the sample that gives their middle
SHAPES = {
    "Sphere": (((1, 0, 0),), (0, 0)),
    "Rectangle": (((1, 1, 0), (1, -1, 0)), (0.5, 0.5)),
    "Disk": (((1, 0, 0), (0, 1, 0)), (0.5, 0.5)),
}


@dataclass(frozen=True)
class Lamp:
    """A light of a scene.

    emitter : Mitsuba's.
    middle : the sample for which `sample_direction` of the emitter gives its middle.
    shape : that of an area emitter, None of a point, a spot or a direction.
    """

    emitter: Any
    middle: tuple[float, float]
    shape: Any = None

    def sphere(self, si, ds, far):
        """The centre and the radius of the sphere about the light, with their derivatives."""
        import mitsuba as mi

        if self.shape is None:
            infinite = mi.has_flag(self.emitter.flags(), mi.EmitterFlags.Infinite)
            return (si.p + ds.d * far if infinite else ds.p), mi.Float(0)
        to_world = mi.traverse(self.shape)["to_world"]
        edges, _ = SHAPES[kind(self.shape)]
        sizes = [dr.norm(to_world @ mi.Vector3f(*edge)) for edge in edges]
        return to_world @ mi.Point3f(0), dr.maximum(sizes[0], sizes[-1])

    def middle_light(self, si, active):
        """Its direction, and its radiance times the solid angle by which its middle stands for all.

        That is π (r/d)² of a sphere, with which a matte surface is lit exactly, and A cosθ / d² of
        a rectangle or disk of area A. A point or a direction has no solid angle.
        """
        import mitsuba as mi

        ds, light = self.emitter.sample_direction(si, mi.Point2f(*self.middle), active)
        if self.shape is not None and kind(self.shape) == "Sphere":
            centre, radius = self.sphere(si, ds, 0)
            sin2 = dr.minimum(radius * radius / dr.squared_norm(centre - si.p), 1)
            light = light * (1 + dr.safe_sqrt(1 - sin2)) / 2  # Mitsuba's is 2π (1 - cos)
        return ds, light


def kind(shape):
    """The name in `SHAPES` of a shape of Mitsuba's, None where it is none of them."""
    import mitsuba as mi

    return next((k for k in SHAPES if shape.shape_type() == int(getattr(mi.ShapeType, k))), None)


def lamps_of(scene):
    """The `Lamp`s of a scene, without its environment.

    Raises `BrdfkitError` where it has shapes that are no lamps, or nothing that gives light.
    """
    import mitsuba as mi

    for shape in scene.shapes():
        if not shape.is_emitter() or kind(shape) is None:
            raise BrdfkitError(
                f"distance_field: the shape {shape.id()!r} is no lamp; besides the field there may "
                "be area emitters on spheres, rectangles and disks (a mesh becomes a field by "
                "brdfkit.distance_fields.from_mesh)."
            )
    if not scene.emitters():
        raise BrdfkitError("distance_field: the scene has no light; add an emitter.")
    of_shapes = [Lamp(s.emitter(), SHAPES[kind(s)][1], s) for s in scene.shapes()]
    points = [e for e in scene.emitters() if mi.has_flag(e.flags(), mi.EmitterFlags.Delta)]
    return of_shapes + [Lamp(e, (0.5, 0.5)) for e in points]
