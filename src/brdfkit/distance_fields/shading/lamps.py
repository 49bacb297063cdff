"""The lights of a scene as spheres: spherical lamps, and spheres around rectangles and disks.

[Bálint et al. 2019, section 5.3]
"""

from dataclasses import dataclass
from typing import Any

import drjit as dr

from brdfkit.core.array_types import JitColour, JitFloat, JitMask, JitVector, MitsubaObject
from brdfkit.core.errors import BrdfkitError

# Mitsuba's shapes that may be lamps: points on their edges, in their own coordinates, and the
# random numbers for which Mitsuba samples their centre
SHAPES: dict[str, Any] = {
    "Sphere": (((1, 0, 0),), (0, 0)),
    "Rectangle": (((1, 1, 0), (1, -1, 0)), (0.5, 0.5)),
    "Disk": (((1, 0, 0), (0, 1, 0)), (0.5, 0.5)),
}


@dataclass(frozen=True)
class Lamp:
    """A light of a scene.

    emitter : the Mitsuba emitter.
    middle : the random numbers for which the emitter's `sample_direction` gives its centre.
    shape : the shape of an area emitter; None for a point, a spot or a directional light.
    """

    emitter: Any
    middle: tuple[float, float]
    shape: Any = None

    def bounding_sphere(
        self, si: MitsubaObject, ds: MitsubaObject, far: JitFloat
    ) -> tuple[JitVector, JitFloat]:
        """Return the centre and the radius of the sphere around the light, with derivatives.

        The radius is 0 for a light without a shape; a directional light has its centre at the
        distance `far`.

        si : surface interactions at the points that are lit.
        ds : direction samples from there to the light.
        """
        import mitsuba as mi

        if self.shape is None:
            infinite = mi.has_flag(self.emitter.flags(), mi.EmitterFlags.Infinite)
            return (si.p + ds.d * far if infinite else ds.p), mi.Float(0)
        to_world = mi.traverse(self.shape)["to_world"]
        edges, _ = SHAPES[find_lamp_shape(self.shape)]
        sizes = [dr.norm(to_world @ mi.Vector3f(*edge)) for edge in edges]
        return to_world @ mi.Point3f(0), dr.maximum(sizes[0], sizes[-1])

    def sample_centre(self, si: MitsubaObject, active: JitMask) -> tuple[MitsubaObject, JitColour]:
        """Return the direction to the light's centre, and its radiance times a solid angle.

        The solid angle is π (r/d)² for a sphere of radius r at the distance d, with which a matte
        surface is lit exactly. It is A cosθ / d² for a rectangle or disk of area A, seen at the
        angle θ to its normal. For a point or directional light, it is left out.
        """
        import mitsuba as mi

        ds, light = self.emitter.sample_direction(si, mi.Point2f(*self.middle), active)
        if self.shape is not None and find_lamp_shape(self.shape) == "Sphere":
            centre, radius = self.bounding_sphere(si, ds, 0)
            sin2 = dr.minimum(radius * radius / dr.squared_norm(centre - si.p), 1)
            # From Mitsuba's solid angle of a sphere, 2π (1 - cosα), to π sin²α
            light = light * (1 + dr.safe_sqrt(1 - sin2)) / 2
        return ds, light


def find_lamp_shape(shape: MitsubaObject) -> Any:
    """Return the name in `SHAPES` of a Mitsuba shape, or None if the shape cannot be a lamp."""
    import mitsuba as mi

    return next((k for k in SHAPES if shape.shape_type() == int(getattr(mi.ShapeType, k))), None)


def find_lamps(scene: MitsubaObject) -> list[Lamp]:
    """Return the lamps of a scene, without its environment.

    Raises `BrdfkitError` for shapes that are no lamps, and for a scene without light.
    """
    import mitsuba as mi

    for shape in scene.shapes():
        if not shape.is_emitter() or find_lamp_shape(shape) is None:
            raise BrdfkitError(
                f"distance_field: the shape {shape.id()!r} is not a lamp; remove it: the only "
                "shapes besides the field may be area emitters on spheres, rectangles and disks "
                "(brdfkit.distance_fields.from_mesh makes a field of a mesh)."
            )
    if not scene.emitters():
        raise BrdfkitError("distance_field: the scene has no light; add an emitter.")
    of_shapes = [Lamp(s.emitter(), SHAPES[find_lamp_shape(s)][1], s) for s in scene.shapes()]
    points = [e for e in scene.emitters() if mi.has_flag(e.flags(), mi.EmitterFlags.Delta)]
    return of_shapes + [Lamp(e, (0.5, 0.5)) for e in points]
