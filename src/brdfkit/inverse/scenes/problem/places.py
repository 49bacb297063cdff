"""Places of lamps as numbers that `refine` searches: positions, and directions of distant lamps.

Mitsuba keeps both in the 4 × 4 matrix `to_world` of a lamp or of its shape. Three numbers of a
position are the matrix's last column. A direction has two free numbers: the components of the unit
vector along the two axes that it is least parallel to at the start; the third one follows.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from brdfkit.core.array_types import FloatArray, MitsubaObject
from brdfkit.regression.certainty import Certainty

# Emitters whose `to_world` says where they are; that of a DirectionalEmitter says where it shines
WITH_POSITION = "SpotLight", "Projector"
LARGEST_SINE = 0.999  # of the angle between a direction and the axis of its dependent component


@dataclass(frozen=True)
class Place:
    """The place in a lamp's matrix `to_world` at the start of a search.

    matrix : the 4 × 4 matrix.
    axis : the axis of the component of a direction that follows from the others; None for a
        position.
    """

    matrix: FloatArray
    axis: int | None = None

    @property
    def free(self) -> list[int]:
        """The components that are searched."""
        return [i for i in range(3) if i != self.axis]

    @property
    def start(self) -> FloatArray:
        """The searched numbers at the start."""
        column = self.matrix[:3, 3] if self.axis is None else _normalise(self.matrix[:3, 2])
        return np.array(column[self.free])

    def to_vector(self, numbers: FloatArray) -> FloatArray:
        """Return the position or the unit direction (3,) of searched numbers."""
        if self.axis is None:
            return np.array(numbers, float)
        numbers = numbers * min(1, LARGEST_SINE / max(float(np.linalg.norm(numbers)), 1e-300))
        vector = np.zeros(3)
        vector[self.free] = numbers
        vector[self.axis] = np.copysign(np.sqrt(1 - numbers @ numbers), self.matrix[self.axis, 2])
        return vector

    def differentiate_dependent(self, numbers: FloatArray) -> FloatArray:
        """Return the derivatives (2,) of a direction's dependent component by the searched ones."""
        assert self.axis is not None
        vector = self.to_vector(numbers)
        return -vector[self.free] / vector[self.axis]

    def make_transform(self, vector: FloatArray) -> MitsubaObject:
        """Return Mitsuba's transform with another position or direction (3,)."""
        moved = self.matrix.copy()
        if self.axis is None:
            moved[:3, 3] = vector
        else:
            turn = _make_rotation(_normalise(self.matrix[:3, 2]), _normalise(vector))
            moved[:3, :3] = turn @ moved[:3, :3]
        return _make_opaque_transform(moved)


def find_place(parameters: MitsubaObject, key: str) -> Place | None:
    """Return the `Place` of a lamp if the entry `key` of a scene holds one as a transform.

    `parameters` is the result of `mitsuba.traverse` for the scene.
    """
    import mitsuba as mi

    owner = parameters.properties[key][2]
    if key.rpartition(".")[2] != "to_world":
        return None
    kind = owner.class_name() if isinstance(owner, mi.Emitter) else ""
    if kind in WITH_POSITION or (isinstance(owner, mi.Shape) and owner.is_emitter()):
        return Place(_read_matrix(parameters[key]))
    if kind == "DirectionalEmitter":
        matrix = _read_matrix(parameters[key])
        return Place(matrix, int(np.argmax(np.abs(matrix[:3, 2]))))
    return None


def is_position_of_point_lamp(parameters: MitsubaObject, key: str) -> bool:
    """Return whether an entry is the position of a point lamp, which is a vector of its own."""
    import mitsuba as mi

    owner = parameters.properties[key][2]
    return isinstance(owner, mi.Emitter) and key.rpartition(".")[2] == "position"


def find_sight(sensors: list[MitsubaObject], scene: MitsubaObject) -> FloatArray | None:
    """Return the mean point (3,) of the scene that the cameras see in the middle of their pictures.

    Returns None if they see no surface there.
    """
    import drjit as dr
    import mitsuba as mi

    points = []
    for sensor in {id(sensor): sensor for sensor in sensors}.values():
        rows, columns = dr.meshgrid(*[dr.linspace(mi.Float, 0.3, 0.7, 5)] * 2)
        film, aperture = mi.Point2f(rows, columns), mi.Point2f(0.5)
        ray, _ = sensor.sample_ray(mi.Float(0), mi.Float(0.5), film, aperture)
        seen = scene.ray_intersect(ray)
        points.append(np.array(seen.p).T[np.array(seen.is_valid())])
    found = np.concatenate(points)
    return found.mean(axis=0) if len(found) else None


def add_dependent_components(
    certainty: Certainty, places: dict[str, tuple[Place, FloatArray]]
) -> Certainty:
    """Return the `Certainty` of directions with the component that follows from the others.

    `places` holds the `Place` and the searched numbers of each direction, by its name.
    """
    for name, (place, numbers) in places.items():
        names = [f"{name}[{i}]" for i in place.free]
        if not set(names) <= set(certainty.names):
            continue
        rows = [certainty.names.index(one) for one in names]
        slopes = np.zeros((1, len(certainty.names)))
        slopes[0, rows] = place.differentiate_dependent(numbers)
        whole = np.concatenate([np.eye(len(certainty.names)), slopes])
        covariance = whole @ certainty.make_covariance_matrix() @ whole.T
        certainty = replace(
            certainty,
            names=(*certainty.names, f"{name}[{place.axis}]"),
            covariance=tuple(map(tuple, covariance.tolist())),
            freedom=(*certainty.freedom, min(certainty.freedom[row] for row in rows)),
        )
    return certainty


def _read_matrix(transform: MitsubaObject) -> FloatArray:
    """Return the 4 × 4 matrix of Mitsuba's transform."""
    return np.array(transform.matrix, float).reshape(4, 4)


def _make_opaque_transform(matrix: FloatArray) -> MitsubaObject:
    """Return Mitsuba's transform whose numbers do not become constants of kernels."""
    import drjit as dr
    import mitsuba as mi

    entries = [dr.opaque(mi.Float, float(value)) for value in matrix.ravel()]
    return mi.AffineTransform4f(mi.Matrix4f(*entries))


def _make_rotation(before: FloatArray, after: FloatArray) -> FloatArray:
    """Return the smallest rotation (3, 3) that turns one unit vector (3,) into another one."""
    axis, cosine = np.cross(before, after), float(before @ after)
    x, y, z = axis
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    # Rodrigues' formula; opposite vectors have no smallest rotation, and never occur in a search
    rotation: FloatArray = np.eye(3) + cross + cross @ cross / max(1 + cosine, 1e-12)
    return rotation


def _normalise(vector: FloatArray) -> FloatArray:
    """Return a vector divided by its length."""
    unit: FloatArray = vector / np.linalg.norm(vector)
    return unit
