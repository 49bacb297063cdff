"""The pictures of a scene at given parameters, and their derivatives, beside those to reach."""

from contextlib import contextmanager

import drjit as dr
import numpy as np

from brdfkit.errors import BrdfkitError
from brdfkit.jit.first_error import first_error
from brdfkit.refining.leverage import number_blocks
from brdfkit.refining.tensors import tensor_of

DERIVATIVE_COST = 2.3  # of a picture of derivatives, in pictures
STEP = 0.05  # of differences, in coordinates, or of what has no bounds relative to it
BACKWARD = "PRBVolpathIntegrator", "BasicVolumetricPrimitiveRadianceFieldIntegrator"
UNATTACHED = "not attached to the AD graph"  # what Mitsuba says of a picture without derivatives
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
        self.reached = self._joined([target.pixels for target in targets])
        self.weights = self._joined([target.weights for target in targets])
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
        return np.concatenate([np.full(len(u.start), u.limits[end]) for u in self.unknowns])

    @property
    def names(self):
        """A name for each number."""
        return tuple(name for unknown in self.unknowns for name in unknown.names)

    @property
    def linear(self):
        """Whether (n,) pictures of direct light are linear in a number."""
        return np.concatenate([np.full(len(u.start), u.linear) for u in self.unknowns])

    @property
    def endless(self):
        """Whether (n,) a number is a weight of a model, of which there is no largest."""
        known = [bool(u.model) and u.linear and not u.bounded for u in self.unknowns]
        return np.repeat(known, [len(u.start) for u in self.unknowns])

    @property
    def curved(self):
        """Whether (n,) a number lies between two bounds, and pictures are not linear in it."""
        bounded = np.concatenate([np.full(len(u.start), u.bounded) for u in self.unknowns])
        return bounded & ~self.linear

    def residuals(self, x, spp, seed):
        """Rendered less reached pixels (pixels, channels), by `spp` samples of a `seed`."""
        self.put(x)
        return self._render(spp, seed) - self.reached

    def derivatives(self, x, spp, seed):
        """The derivatives (n, pixels, channels) of the pixels by the coordinates."""
        found = np.zeros((len(x), *self.reached.shape), np.float32)
        for numbers in self.tangents:
            _share(self._derivative(x, numbers, spp, seed), found, numbers)
        return found

    @property
    def tangents(self):
        """The numbers of which one picture has the derivatives: those of a colour, or one."""
        for end, unknown in zip(self.ends, self.unknowns, strict=True):
            rows = list(range(end - len(unknown.start), end))
            yield from [rows] if unknown.colour else [[row] for row in rows]

    @property
    def integrator_is_backward(self):
        """Whether the integrator has derivatives only backwards."""
        return type(self.integrator).__name__ in BACKWARD

    def _derivative(self, x, numbers, spp, seed):
        """That of the pixels where the `numbers` move together: by differences where the integrator
        knows none, as of the place of a lamp."""
        picture = None if self.integrator_is_backward else self._forward(x, numbers, spp, seed)
        if picture is None or not picture.any():
            return self._differences(x, numbers, spp, seed)
        return picture

    def steps_from(self, x, numbers, spp, seed):
        """(what each of the `numbers` adds to the pixels, from 0 to 1; the residuals without them).

        Those of a colour change their own channels, and are taken in one picture.
        """
        without = self.residuals(x, spp, seed)
        found = np.zeros((len(numbers), *without.shape), np.float32)
        rows = {number: row for row, number in enumerate(numbers)}
        for group in self.tangents:
            if not rows.keys() >= set(group):
                continue
            moved = np.array(x, float)
            moved[group] = 1
            change = self.residuals(moved, spp, seed) - without
            _share(change, found, [rows[number] for number in group])
        return found, without

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
        self._put(self._entries(x))

    def put_leaves(self, x):
        """The same, ready for derivatives backwards; the entries of the unknowns."""
        leaves = self._entries(x)
        dr.enable_grad(leaves)
        self._put(leaves)
        return leaves

    def _put_moving(self, x, tangent):
        """The same, with derivatives along a `tangent` (n,) of the values: of all unknowns, 0 of
        those that rest, so that all derivatives share one kernel."""
        entries = self._entries(x)
        dr.enable_grad(entries)
        for entry, along in zip(entries, self.parts(tangent), strict=True):
            dr.set_grad(entry, _opaque(type(entry), along))
        self._put(entries)

    def _entries(self, x):
        """What the scene holds of each unknown at the coordinates `x`."""
        values = zip(self.unknowns, self.values(x), strict=True)
        return [_entry(self.parameters, unknown, value) for unknown, value in values]

    def _put(self, entries):
        for unknown, entry in zip(self.unknowns, entries, strict=True):
            self.parameters[unknown.key] = entry
        with first_error():
            self.parameters.update()

    def _render(self, spp, seed):
        self.renders += spp
        with first_error():
            return self._joined(
                [
                    self.integrator.render(
                        self.scene, sensor=sensor, seed=int(seed) + i, spp=int(spp)
                    )
                    for i, sensor in enumerate(self.scene.sensors())
                ]
            )

    def _forward(self, x, numbers, spp, seed):
        """The derivative of the pixels where the `numbers` move together; None where the integrator
        finds nothing to differentiate."""
        self.renders += DERIVATIVE_COST * spp
        tangent = np.zeros(len(x))
        tangent[numbers] = self.slopes(x)[numbers]
        self._put_moving(x, tangent)
        try:
            with first_error():
                found = [
                    self.integrator.render_forward(
                        self.scene, self.parameters, sensor=sensor, seed=int(seed) + i, spp=int(spp)
                    )
                    for i, sensor in enumerate(self.scene.sensors())
                ]
                return self._joined(found)
        except Exception as error:
            if UNATTACHED not in str(error):
                raise
            return None

    def _differences(self, x, numbers, spp, seed):
        """The same by differences of equal samples, for integrators without it."""
        ends = np.array([x, x], float)
        step = STEP * np.maximum(np.abs(x), STEP)
        step[self.most - self.least == 1] = STEP
        ends[:, numbers] += np.outer([-1, 1], step[numbers])
        ends = np.clip(ends, self.least, self.most)
        low, high = (self.residuals(end, spp, seed) for end in ends)
        width = (ends[1] - ends[0])[numbers]
        return (high - low) / (width if len(width) == high.shape[1] else width[0])

    def _joined(self, pictures):
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


def _share(picture, found, rows):
    """Put a picture (pixels, channels) into the `rows` of `found` (n, pixels, channels): whole, or
    to each number of a colour its own channel, for it changes no other."""
    for channel, row in enumerate(rows):
        own = [channel] if 1 < len(rows) == picture.shape[1] else slice(None)
        found[row][:, own] = picture[:, own]


def _entry(parameters, unknown, values):
    """What a scene holds of an unknown's values."""
    if unknown.shape:
        return tensor_of(values, unknown.places)
    return _opaque(type(parameters[unknown.key]), values)


def _opaque(kind, values):
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
