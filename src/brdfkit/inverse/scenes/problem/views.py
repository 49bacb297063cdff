"""The pictures of a scene at given parameters, beside those to reach."""

from contextlib import contextmanager

import drjit as dr
import numpy as np

from brdfkit.core.errors import BrdfkitError
from brdfkit.core.jit.loops import first_error
from brdfkit.inverse.scenes.problem.leverage import number_blocks
from brdfkit.inverse.scenes.problem.tensors import tensor_of

ON_BOUND = 1e-6  # a coordinate so near to a bound is on it


class Views:
    """A scene of Mitsuba's, seen by its sensors, beside a picture to reach for each.

    scene, integrator : Mitsuba's.
    targets : a `Target` for each sensor.
    parameters : what `mitsuba.traverse` says of the scene.
    unknowns : `Unknown`s; their coordinates are the `x` (n,) of all methods.
    seen : which pixels (pixels,) count.
    """

    def __init__(self, scene, integrator, targets, parameters, unknowns):
        self.scene, self.integrator = scene, integrator
        self.targets, self.parameters, self.unknowns = targets, parameters, unknowns
        self.ends = np.cumsum([len(unknown.start) for unknown in unknowns])
        _require_fit(scene, targets)
        self.reached = self.joined([target.pixels for target in targets])
        self.weights = self.joined([target.weights for target in targets])
        self.weights /= sum(target.count for target in targets)
        self.seen = (self.weights > 0).any(axis=1)
        self.blocks = number_blocks(scene, self.seen)
        self.renders = 0.0  # samples per pixel, those of derivatives counted by their time

    def values(self, x):
        """The numbers of each unknown at the coordinates `x`."""
        return [unknown.table(u) for unknown, u in zip(self.unknowns, self.parts(x), strict=True)]

    def slopes(self, x):
        """The derivatives (n,) of the values by their coordinates."""
        parts = zip(self.unknowns, self.parts(x), strict=True)
        return np.concatenate([unknown.slopes(u) for unknown, u in parts])

    def is_on_bound(self, x):
        """Whether (n,) coordinates are on a bound, but for rounding."""
        return (x <= self.least + ON_BOUND) | (x >= self.most - ON_BOUND)

    def parts(self, x):
        """Numbers (n,) as those of each unknown."""
        return np.split(np.asarray(x), self.ends[:-1])

    @property
    def start(self):
        """The coordinates of the scene as it is given."""
        return np.concatenate([unknown.coordinates(unknown.start) for unknown in self.unknowns])

    @property
    def least(self):
        """The least coordinates."""
        return self._limits(0)

    @property
    def most(self):
        """The largest coordinates."""
        return self._limits(1)

    def _limits(self, end):
        return self._of_each(unknown.limits[end] for unknown in self.unknowns)

    def _of_each(self, values):
        """Those of the unknowns, as of each of their numbers (n,)."""
        return np.repeat(list(values), [len(unknown.start) for unknown in self.unknowns])

    @property
    def names(self):
        """A name for each number."""
        return tuple(name for unknown in self.unknowns for name in unknown.names)

    @property
    def linear(self):
        """Whether (n,) pictures of direct light are linear in a number."""
        return self._of_each(unknown.linear for unknown in self.unknowns)

    @property
    def wrongly(self):
        """Whether (n,) Mitsuba's derivatives by a number are wrong."""
        return self._of_each(unknown.wrongly for unknown in self.unknowns)

    @property
    def endless(self):
        """Whether (n,) a number is a weight of a model, of which there is no largest."""
        return self._of_each(bool(u.model) and u.linear and not u.bounded for u in self.unknowns)

    @property
    def curved(self):
        """Whether (n,) a number lies between two bounds, and pictures are not linear in it."""
        return self._of_each(unknown.bounded and not unknown.linear for unknown in self.unknowns)

    def residuals(self, x, spp, seed):
        """Rendered less reached pixels (pixels, channels), by `spp` samples of a `seed`."""
        self.put(x)
        return self._render(spp, seed) - self.reached

    def as_pictures(self, pixels):
        """Pixels (pixels, channels) as a picture (height, width, channels) for each sensor."""
        found = []
        for target in self.targets:
            count = np.prod(target.size)
            found.append(pixels[:count].reshape(target.pixels.shape))
            pixels = pixels[count:]
        return found

    def put(self, x):
        """Put the values at `x` into the scene, and leave them there."""
        self.put_entries(self.entries(x))

    def entries(self, x):
        """What the scene holds of each unknown at the coordinates `x`."""
        values = zip(self.unknowns, self.values(x), strict=True)
        return [_entry(self.parameters, unknown, value) for unknown, value in values]

    def put_entries(self, entries):
        """Put what `entries` of the unknowns hold into the scene."""
        for unknown, entry in zip(self.unknowns, entries, strict=True):
            self.parameters[unknown.key] = entry
        with first_error():
            self.parameters.update()

    def _render(self, spp, seed):
        self.renders += spp
        with first_error():
            return self.joined(
                [
                    self.integrator.render(
                        self.scene, sensor=sensor, seed=int(seed) + i, spp=int(spp)
                    )
                    for i, sensor in enumerate(self.scene.sensors())
                ]
            )

    def joined(self, pictures):
        """Pictures as one array (pixels, channels)."""
        arrays = [np.array(picture, float) for picture in pictures]
        channels = self.targets[0].pixels.shape[2]
        films = {min(a.shape[2], 3) for a in arrays}
        if films != {channels}:
            raise BrdfkitError(
                f"the pictures have {channels} channel{'s' * (channels > 1)}, and a camera's film "
                f"{min(films - {channels})}: they should have as many."
            )
        return np.concatenate([a[..., :channels].reshape(-1, channels) for a in arrays])


@contextmanager
def quiet_samplers():
    """Without Mitsuba's warnings: samplers round the number of samples up, and say so each time."""
    import mitsuba as mi

    level = mi.log_level()
    mi.set_log_level(mi.LogLevel.Error)
    try:
        yield
    finally:
        mi.set_log_level(level)


def _entry(parameters, unknown, values):
    """What a scene holds of an unknown's values."""
    if unknown.shape:
        return tensor_of(values, unknown.places)
    return opaque(type(parameters[unknown.key]), values)


def opaque(kind, values):
    """An array of Dr.Jit's whose numbers are no part of kernels."""
    import mitsuba as mi

    numbers = [dr.opaque(mi.Float, float(v)) for v in values]
    return numbers[0] if len(numbers) == 1 and kind is mi.Float else kind(*numbers)


def _require_fit(scene, targets):
    """Raise `BrdfkitError` unless there is a picture of the right size for each sensor."""
    sensors = scene.sensors()
    if len(sensors) != len(targets):
        raise BrdfkitError(
            f"there should be one picture for each sensor: {len(targets)} for {len(sensors)}."
        )
    for number, (sensor, target) in enumerate(zip(sensors, targets, strict=True)):
        width, height = sensor.film().crop_size()
        if (width, height) != target.size:
            raise BrdfkitError(
                f"picture {number} has {target.size[0]} × {target.size[1]} pixels, and its camera "
                f"{width} × {height}: they should be of one size."
            )
