"""Renders a scene at given parameters and compares its pictures with the target pictures."""

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from typing import Any

import drjit as dr
import numpy as np

from brdfkit.core.array_types import AnyArray, BoolArray, FloatArray, MitsubaObject
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.jit.loops import raise_first_cause
from brdfkit.inverse.scenes.problem.leverage import group_pixels_by_block
from brdfkit.inverse.scenes.problem.parameters import Unknown
from brdfkit.inverse.scenes.problem.targets import Target
from brdfkit.inverse.scenes.problem.tensors import make_tensor

BOUND_DISTANCE = 1e-6  # a search coordinate counts as on a bound if it is nearer to it than this


class Views:
    """A scene, the parameters to search in it, and a target picture for each of its sensors.

    The n numbers of all unknowns form one vector of search coordinates `x` (n,), which all methods
    take. The pixels of all sensors form one axis.

    scene, integrator : Mitsuba's objects.
    targets : a `Target` for each sensor.
    parameters : the result of `mitsuba.traverse` for the scene.
    unknowns : the entries to search.
    target_pixels, weights : the targets' pixels and weights, (pixels, channels).
    counted : the mask (pixels,) of pixels with a weight above 0.
    blocks : the blocks of pixels whose noise is correlated.
    names : a name for each number.
    start : the coordinates (n,) of the scene's own values, where the search begins.
    lower_bounds, upper_bounds : the bounds (n,) of the coordinates.
    is_linear : whether pictures of direct light are linear in each number (n,).
    is_nonlinear_share : whether each number (n,) has finite bounds, and pictures are not linear.
    is_unlimited_weight : whether each number (n,) is a lobe's weight without an upper bound.
    has_wrong_derivatives : whether Mitsuba's derivatives for each number (n,) are wrong.
    cost : samples per pixel rendered so far; derivatives count as many as take the same time.
    """

    def __init__(
        self,
        scene: MitsubaObject,
        integrator: MitsubaObject,
        targets: list[Target],
        parameters: MitsubaObject,
        unknowns: list[Unknown],
    ) -> None:
        self.scene, self.integrator = scene, integrator
        self.targets, self.parameters, self.unknowns = targets, parameters, unknowns
        self.ends = np.cumsum([len(unknown.start) for unknown in unknowns])
        _check_picture_sizes(scene, targets)
        self.target_pixels = self.join_pictures([target.pixels for target in targets])
        self.weights = self.join_pictures([target.weights for target in targets])
        self.weights /= sum(target.count for target in targets)
        self.counted: BoolArray = np.any(self.weights > 0, axis=1)
        self.blocks = group_pixels_by_block(scene, self.counted)
        self.names = tuple(name for unknown in unknowns for name in unknown.names)
        self.start = np.concatenate([u.to_coordinates(u.start) for u in unknowns])

        def repeat_by_number(values: Iterable[Any]) -> AnyArray:
            """Return one value for each unknown, repeated for each of its numbers: (n,)."""
            return np.repeat(list(values), [len(unknown.start) for unknown in unknowns])

        self.lower_bounds = repeat_by_number(u.limits[0] for u in unknowns)
        self.upper_bounds = repeat_by_number(u.limits[1] for u in unknowns)
        self.is_linear = repeat_by_number(u.is_linear for u in unknowns)
        self.is_nonlinear_share = repeat_by_number(
            u.is_bounded and not u.is_linear for u in unknowns
        )
        self.is_unlimited_weight = repeat_by_number(
            u.model is not None and u.is_linear and not u.is_bounded for u in unknowns
        )
        self.has_wrong_derivatives = repeat_by_number(u.has_wrong_derivatives for u in unknowns)
        self.cost = 0.0

    def to_values(self, x: FloatArray) -> list[FloatArray]:
        """Return the numbers of each unknown at the search coordinates `x`."""
        return [
            u.to_values(part)
            for u, part in zip(self.unknowns, self.split_by_unknown(x), strict=True)
        ]

    def differentiate_values(self, x: FloatArray) -> FloatArray:
        """Return the derivatives (n,) of values with respect to their search coordinates `x`."""
        parts = zip(self.unknowns, self.split_by_unknown(x), strict=True)
        return np.concatenate([unknown.differentiate_values(part) for unknown, part in parts])

    def is_on_bound(self, x: FloatArray) -> BoolArray:
        """Return which search coordinates (n,) are on a bound, up to rounding."""
        return (x <= self.lower_bounds + BOUND_DISTANCE) | (x >= self.upper_bounds - BOUND_DISTANCE)

    def split_by_unknown(self, x: AnyArray) -> list[AnyArray]:
        """Return an array (n,), a value for each number, split into the part of each unknown."""
        return np.split(np.asarray(x), self.ends[:-1])

    def render_residuals(self, x: FloatArray, spp: int, seed: int) -> FloatArray:
        """Return rendered minus target pixels (pixels, channels) at `x`, with `spp` samples."""
        self.write_to_scene(x)
        self.cost += spp
        with raise_first_cause():
            pictures = [
                self.integrator.render(self.scene, sensor=sensor, seed=int(seed) + i, spp=int(spp))
                for i, sensor in enumerate(self.scene.sensors())
            ]
            return self.join_pictures(pictures) - self.target_pixels

    def split_pictures(self, pixels: AnyArray) -> list[AnyArray]:
        """Return pixels (pixels, channels) as a picture (height, width, channels) per sensor."""
        pictures = []
        for target in self.targets:
            count = np.prod(target.size)
            pictures.append(pixels[:count].reshape(target.pixels.shape))
            pixels = pixels[count:]
        return pictures

    def join_pictures(self, pictures: Iterable[Any]) -> FloatArray:
        """Return one picture per sensor as pixels (pixels, channels) of all sensors."""
        arrays = [np.array(picture, float) for picture in pictures]
        channels = self.targets[0].pixels.shape[2]
        films = {min(a.shape[2], 3) for a in arrays}
        if films != {channels}:
            raise BrdfkitError(
                f"the pictures have {channels} channel{'s' * (channels > 1)}, and a camera's film "
                f"{min(films - {channels})}: they should have as many."
            )
        return np.concatenate([a[..., :channels].reshape(-1, channels) for a in arrays])

    def write_to_scene(self, x: FloatArray) -> None:
        """Write the values at the search coordinates `x` into the scene."""
        self.write_entries(self.make_entries(x))

    def make_entries(self, x: FloatArray) -> list[MitsubaObject]:
        """Return the values at `x` as Mitsuba's arrays or tensors, one per unknown."""
        entries = []
        for unknown, values in zip(self.unknowns, self.to_values(x), strict=True):
            if unknown.texels is not None:
                entries.append(make_tensor(values, unknown.texels))
            else:
                entries.append(make_opaque_array(type(self.parameters[unknown.key]), values))
        return entries

    def write_entries(self, entries: list[MitsubaObject]) -> None:
        """Write Mitsuba's arrays or tensors, one per unknown, into the scene."""
        for unknown, entry in zip(self.unknowns, entries, strict=True):
            self.parameters[unknown.key] = entry
        with raise_first_cause():
            self.parameters.update()


@contextmanager
def suppress_sampler_warnings() -> Iterator[None]:
    """Suppress Mitsuba's warnings within a block: samplers warn whenever they round up a count."""
    import mitsuba as mi

    level = mi.log_level()
    mi.set_log_level(mi.LogLevel.Error)
    try:
        yield
    finally:
        mi.set_log_level(level)


def make_opaque_array(kind: type, values: AnyArray) -> MitsubaObject:
    """Return a Dr.Jit array of type `kind` whose numbers do not become constants of kernels.

    All values then share one kernel, which is compiled once.
    """
    import mitsuba as mi

    numbers = [dr.opaque(mi.Float, float(v)) for v in values]
    return numbers[0] if len(numbers) == 1 and kind is mi.Float else kind(*numbers)


def _check_picture_sizes(scene: MitsubaObject, targets: list[Target]) -> None:
    """Raise `BrdfkitError` unless there is a target of the right size for each sensor."""
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
