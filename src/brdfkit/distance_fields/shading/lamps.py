"""The lights of a scene as spheres: spherical lamps, and spheres around rectangles and disks.

[Bálint et al. 2019, section 5.3]
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import product
from typing import Any

import drjit as dr

from brdfkit.core.array_types import (
    JitColour,
    JitFloat,
    JitInt,
    JitMask,
    JitVector,
    MitsubaObject,
)
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

    emitter : `mi.EmitterPtr`.
    middle : the random numbers for which the emitter's `sample_direction` gives its centre.
    has_shape : False for a point, a spot or a directional light.
    centre, radius : the sphere around the shape, with derivatives.
    is_sphere : Bool, whether the shape is that sphere.
    """

    emitter: Any
    middle: Any
    has_shape: bool
    centre: Any
    radius: Any
    is_sphere: Any

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

        if self.has_shape:
            return self.centre, self.radius
        infinite = mi.has_flag(self.emitter.flags(), mi.EmitterFlags.Infinite)
        return dr.select(infinite, si.p + ds.d * far, ds.p), mi.Float(0)

    def sample_centre(self, si: MitsubaObject, active: JitMask) -> tuple[MitsubaObject, JitColour]:
        """Return the direction to the light's centre, and its radiance times a solid angle.

        The solid angle is π (r/d)² for a sphere of radius r at the distance d, with which a matte
        surface is lit exactly. It is A cosθ / d² for a rectangle or disk of area A, seen at the
        angle θ to its normal. For a point or directional light, it is left out.
        """
        ds, light = self.emitter.sample_direction(si, self.middle, active)
        if self.has_shape:
            sin2 = dr.minimum(dr.square(self.radius) / dr.squared_norm(self.centre - si.p), 1)
            # From Mitsuba's solid angle of a sphere, 2π (1 - cosα), to π sin²α
            light = light * dr.select(self.is_sphere, (1 + dr.safe_sqrt(1 - sin2)) / 2, 1)
        return ds, light


@dataclass(frozen=True)
class Lamps:
    """Several lights of a scene, all with shapes or all without.

    count : the number of the lights.
    arrays : a `Lamp` whose fields have one entry for each light.
    """

    count: int
    arrays: Lamp

    def select_lamp(self, i: JitInt) -> Lamp:
        """Return the i-th light."""
        of_shapes = ("centre", "radius", "is_sphere") if self.arrays.has_shape else ()
        fields = {name: getattr(self.arrays, name) for name in ("emitter", "middle", *of_shapes)}
        one = {name: dr.gather(type(field), field, i) for name, field in fields.items()}
        return replace(self.arrays, **one)

    def sum_up(
        self, light: Callable[[Lamp, MitsubaObject], JitColour], sampler: MitsubaObject
    ) -> JitColour:
        """Return the sum of `light(lamp, sampler)` over all lights.

        A loop takes one after the other, so that a kernel for many is made as fast as for two.
        Where loops are not recorded, while Mitsuba differentiates, it would be slower than none.
        """
        import mitsuba as mi

        if self.count == 1 or not dr.flag(dr.JitFlag.SymbolicLoops):
            places = map(mi.UInt32, range(self.count))
            each = (light(self.select_lamp(i), sampler) for i in places)
            return sum(each, mi.UnpolarizedSpectrum(0))
        _, _, total = dr.while_loop(
            (mi.UInt32(0), sampler, mi.UnpolarizedSpectrum(0)),
            lambda i, sampler, total: i < self.count,
            lambda i, sampler, total: (
                i + 1,
                sampler,
                total + light(self.select_lamp(i), sampler),
            ),
            max_iterations=self.count,
        )
        return total


def find_lamp_shape(shape: MitsubaObject) -> Any:
    """Return the name in `SHAPES` of a Mitsuba shape, or None if the shape cannot be a lamp."""
    import mitsuba as mi

    return next((k for k in SHAPES if shape.shape_type() == int(getattr(mi.ShapeType, k))), None)


def find_lamps(scene: MitsubaObject) -> list[Lamps]:
    """Return the lamps of a scene, without its environment: those with shapes, and the others.

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
    shapes, emitters = scene.shapes(), list(scene.emitters())
    points = [e for e in emitters if mi.has_flag(e.flags(), mi.EmitterFlags.Delta)]
    kinds = [s.emitter() for s in shapes], points
    return [
        make_lamps(scene, [emitters.index(e) for e in kind], shapes if kind is kinds[0] else [])
        for kind in kinds
        if kind
    ]


def make_lamps(
    scene: MitsubaObject, places: Sequence[int], shapes: Sequence[MitsubaObject]
) -> Lamps:
    """Return the emitters at `places` of a scene's list; `shapes` are theirs, or empty."""
    import mitsuba as mi

    emitter = dr.gather(mi.EmitterPtr, scene.emitters_dr(), mi.UInt32(list(places)))
    kinds = [find_lamp_shape(shape) for shape in shapes]
    # Lists, not NumPy's arrays: kernels depend on how the memory of those is aligned
    middles = [SHAPES[kind][1] for kind in kinds] or [(0.5, 0.5)] * len(places)
    centres, radii = bound_shapes(shapes, kinds)
    middle = mi.Point2f(*(mi.Float(list(part)) for part in zip(*middles, strict=True)))
    is_sphere = mi.Bool([kind == "Sphere" for kind in kinds] or [False])
    lamps = Lamp(emitter, middle, bool(shapes), centres, radii, is_sphere)
    return Lamps(len(places), lamps)


def bound_shapes(
    shapes: Sequence[MitsubaObject], kinds: Sequence[str]
) -> tuple[JitVector, JitFloat]:
    """Return the centres and the radii of spheres around shapes, with derivatives.

    A kernel with all numbers of the matrices of many lamps takes seconds to make. So each matrix is
    made one array first, by a kernel that is the same for all.
    """
    import mitsuba as mi

    if not shapes:
        return mi.Point3f(0), mi.Float(0)
    places = list(product(range(4), range(3)))  # by columns
    numbers: list[list[JitFloat]] = []  # of each shape
    for shape in shapes:
        matrix = mi.traverse(shape)["to_world"].matrix
        numbers.append([matrix[row, column] for column, row in places])
    parts = numbers[0]
    if len(shapes) > 1:
        joined = []
        for of_shape in numbers:
            joined.append(dr.concat(of_shape))
            dr.eval(joined[-1])
        table, first = dr.concat(joined), len(places) * dr.arange(mi.UInt32, len(shapes))
        parts = [dr.gather(mi.Float, table, first + place) for place in range(len(places))]
    x, y, z, centres = (mi.Vector3f(*parts[3 * c : 3 * c + 3]) for c in range(4))
    sizes = []
    for place in (0, -1):
        edges = zip(*(SHAPES[kind][0][place] for kind in kinds), strict=True)
        along: MitsubaObject = [mi.Float(list(part)) for part in edges]
        sizes.append(dr.norm(x * along[0] + y * along[1] + z * along[2]))
    return mi.Point3f(centres), dr.maximum(*sizes)
