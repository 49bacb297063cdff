"""Maps of a model's parameters and of the normal, and the rows of numbers that they are made of."""

from dataclasses import dataclass

import numpy as np

from brdfkit.inverse.photographs.maps.shape_parameters import ANGLE
from brdfkit.inverse.photographs.maps.texel_parameters import CHANNELS, Numbers
from brdfkit.model import labels


@dataclass(frozen=True)
class Maps:
    """The `maps` by name of a sample of `size` [m]: of a `model`, whose other shape parameters are
    `fixed`."""

    model: type
    fixed: dict[str, float]
    size: tuple[float, float]
    maps: dict[str, np.ndarray]

    @classmethod
    def of(cls, numbers, x, shape, size):
        """Of rows `x` (n, count) of `Numbers`, for a map of `shape`."""
        return cls(numbers.model, numbers.fixed, size, maps_of(numbers, x, shape))


def numbers_of(svbrdf):
    """The `Numbers` of `Maps`, or of an `Svbrdf`, and its rows (n, count)."""
    model, maps = labels.model(svbrdf.model), svbrdf.maps
    weights = model.weights()
    names = tuple(name for name in maps if name not in (*weights, "normal", ANGLE))
    numbers = Numbers(model, names, svbrdf.fixed, pair_of(model, names) if ANGLE in maps else None)
    columns = [maps[name].reshape(-1, CHANNELS) for name in weights]
    shapes = [n.reshape(-1, 1) for n in numbers.form.numbers(maps)]
    normals = maps["normal"].reshape(-1, 3)[:, :2]
    return numbers, np.concatenate([*columns, *shapes, normals], axis=1)


def pair_of(model, names):
    """The shape parameters (u, v) among the `names` that are widths along two directions."""
    return next(
        ((p.follows, name) for name, p in model.parameters.items() if p.follows and name in names),
        None,
    )


def maps_of(numbers, x, shape):
    """The maps by name of rows `x` (n, count)."""
    height, width = shape
    found = {}
    for lobe, name in enumerate(numbers.lobes):
        found[name] = x[:, CHANNELS * lobe : CHANNELS * (lobe + 1)].reshape(height, width, CHANNELS)
    shapes = numbers.form.values(x[:, numbers.shapes].T)
    found |= {name: values.reshape(shape) for name, values in shapes.items()}
    slant = x[:, numbers.normal]
    z = np.sqrt(np.maximum(1 - (slant**2).sum(axis=1), 1e-4))
    normals = np.concatenate([slant, z[:, None]], axis=1)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    return found | {"normal": normals.reshape(height, width, 3)}


def errors_of(numbers, errors, x, shape):
    """The standard errors (height, width) by name, of `errors` (n, count) of the rows `x`."""
    found = {}
    for lobe, name in enumerate(numbers.lobes):
        own = errors[:, CHANNELS * lobe : CHANNELS * (lobe + 1)]
        found[name] = np.sqrt((own**2).mean(axis=1))
    found |= numbers.form.errors(x[:, numbers.shapes].T, errors[:, numbers.shapes].T)
    found["normal"] = np.sqrt((errors[:, numbers.normal] ** 2).sum(axis=1))
    return {name: error.reshape(shape) for name, error in found.items()}
