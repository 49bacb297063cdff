"""Maps of a model's parameters and of the normal, and the rows of numbers that they are made of."""

from dataclasses import dataclass

import numpy as np

from brdfkit.model import labels
from brdfkit.photographs.numbers import CHANNELS, Numbers


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
    names = tuple(name for name in maps if name not in (*weights, "normal"))
    numbers = Numbers(model, names, svbrdf.fixed)
    columns = [maps[name].reshape(-1, CHANNELS) for name in weights]
    shapes = numbers.coordinates({name: maps[name].reshape(-1, 1) for name in names})
    normals = maps["normal"].reshape(-1, 3)[:, :2]
    return numbers, np.concatenate([*columns, *shapes, normals], axis=1)


def maps_of(numbers, x, shape):
    """The maps by name of rows `x` (n, count)."""
    height, width = shape
    found = {}
    for lobe, name in enumerate(numbers.lobes):
        found[name] = x[:, CHANNELS * lobe : CHANNELS * (lobe + 1)].reshape(height, width, CHANNELS)
    found |= {name: values.reshape(shape) for name, values in numbers.values(x).items()}
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
    for (name, values), error in zip(
        numbers.values(x).items(), errors[:, numbers.shapes].T, strict=True
    ):
        found[name] = values * error if numbers.model.parameters[name].log else error
    found["normal"] = np.sqrt((errors[:, numbers.normal] ** 2).sum(axis=1))
    return {name: error.reshape(shape) for name, error in found.items()}
