"""The lights of a scene as spheres: spherical lamps, and spheres about rectangles and disks.

[Bálint et al. 2019, section 5.3]
"""

from dataclasses import dataclass
from typing import Any

import drjit as dr

from brdfkit.core.array_types import JitColour, JitFloat, JitMask, JitVector, MitsubaObject
from brdfkit.core.errors import BrdfkitError

# Mitsuba's shapes that may be lamps: points of their edges, and the sample that gives their centre
SHAPES: dict[str, Any] = {
    "Sphere": (((1, 0, 0),), (0, 0)),
    "Rectangle": (((1, 1, 0), (1, -1, 0)), (0.5, 0.5)),
    "Disk": (((1, 0, 0), (0, 1, 0)), (0.5, 0.5)),
}


@dataclass(frozen=True)
class Lamp:
    """A light of a scene.

    emitter : the Mitsuba emitter.
    middle : the sample for which the emitter's `sample_direction` gives its centre.
    shape : the shape of an area emitter; None for a point, a spot or a directional light.
    """

    emitter: Any
    middle: tuple[float, float]
    shape: Any = None

    def sphere(
        self, si: MitsubaObject, ds: MitsubaObject, far: JitFloat
    ) -> tuple[JitVector, JitFloat]:
        """Return the centre and the radius of the sphere about the light, with derivatives.

        A light without a shape has the radius 0; a directional one lies at the distance `far`.
        """
        import mitsuba as mi

        if self.shape is None:
            infinite = mi.has_flag(self.emitter.flags(), mi.EmitterFlags.Infinite)
            return (si.p + ds.d * far if infinite else ds.p), mi.Float(0)
        to_world = mi.traverse(self.shape)["to_world"]
        edges, _ = SHAPES[lamp_shape(self.shape)]
        sizes = [dr.norm(to_world @ mi.Vector3f(*edge)) for edge in edges]
        return to_world @ mi.Point3f(0), dr.maximum(sizes[0], sizes[-1])

    def sample_middle(self, si: MitsubaObject, active: JitMask) -> tuple[MitsubaObject, JitColour]:
        """Return the direction to the light's centre, and its radiance times a solid angle.

        The solid angle is π (r/d)² for a sphere, with which a matte surface is lit exactly, and
        A cosθ / d² for a rectangle or disk of area A. A point or directional light has none.
        """
        import mitsuba as mi

        ds, light = self.emitter.sample_direction(si, mi.Point2f(*self.middle), active)
        if self.shape is not None and lamp_shape(self.shape) == "Sphere":
            centre, radius = self.sphere(si, ds, 0)
            sin2 = dr.minimum(radius * radius / dr.squared_norm(centre - si.p), 1)
            light = light * (1 + dr.safe_sqrt(1 - sin2)) / 2  # Mitsuba's is 2π (1 - cos)
        return ds, light


def lamp_shape(shape: MitsubaObject) -> Any:
    """Return the name in `SHAPES` of a Mitsuba shape, or None if it is none of them."""
    import mitsuba as mi

    return next((k for k in SHAPES if shape.shape_type() == int(getattr(mi.ShapeType, k))), None)


def find_lamps(scene: MitsubaObject) -> list[Lamp]:
    """Return the lamps of a scene, without its environment.

    Raises `BrdfkitError` for shapes that are no lamps, and for a scene without light.
    """
    import mitsuba as mi

    for shape in scene.shapes():
        if not shape.is_emitter() or lamp_shape(shape) is None:
            raise BrdfkitError(
                f"distance_field: the shape {shape.id()!r} is no lamp; besides the field there may "
                "be area emitters on spheres, rectangles and disks (a mesh becomes a field by "
                "brdfkit.distance_fields.from_mesh)."
            )
    if not scene.emitters():
        raise BrdfkitError("distance_field: the scene has no light; add an emitter.")
    of_shapes = [Lamp(s.emitter(), SHAPES[lamp_shape(s)][1], s) for s in scene.shapes()]
    points = [e for e in scene.emitters() if mi.has_flag(e.flags(), mi.EmitterFlags.Delta)]
    return of_shapes + [Lamp(e, (0.5, 0.5)) for e in points]
