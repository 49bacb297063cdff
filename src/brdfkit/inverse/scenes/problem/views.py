"""Renders a scene at given parameters and compares its pictures with the target pictures."""

from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from typing import Any

import numpy as np

from brdfkit.core.array_types import AnyArray, BoolArray, FloatArray, MitsubaObject
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.jit.loops import raise_first_cause
from brdfkit.inverse.scenes.problem.by_picture import choose_sensors
from brdfkit.inverse.scenes.problem.lamps import Lighting, find_lamp_keys
from brdfkit.inverse.scenes.problem.leverage import group_pixels_by_block
from brdfkit.inverse.scenes.problem.parameters import Unknown
from brdfkit.inverse.scenes.problem.places import find_sight
from brdfkit.inverse.scenes.problem.targets import Target
from brdfkit.inverse.scenes.problem.tensors import make_opaque_array, make_tensor

BOUND_DISTANCE = 1e-6  # a search coordinate counts as on a bound if it is nearer to it than this


class Views:
    """A scene, the parameters to search in it, and the pictures of it to match.

    The n numbers of all unknowns form one vector of search coordinates `x` (n,), which all methods
    take. The pixels of all pictures form one axis.

    scene, integrator : Mitsuba's objects.
    targets : a `Target` for each picture.
    sensors : the sensor of the scene that took each picture.
    lighting : which lamps burn in which picture, or None if all of them always do.
    parameters : the result of `mitsuba.traverse` for the scene.
    unknowns : the entries to search.
    target_pixels, weights : the targets' pixels and weights, (pixels, channels).
    counted : the mask (pixels,) of pixels with a weight above 0.
    blocks : the blocks of pixels whose noise is correlated.
    names : a name for each number.
    start : the coordinates (n,) of the scene's own values, where the search begins.
    lower_bounds, upper_bounds : the bounds (n,) of the coordinates.
    is_linear : whether pictures of direct light are linear in each number (n,).
    is_lamp : whether each number (n,) belongs to an emitter.
    is_nonlinear_share : whether each number (n,) has finite bounds, and pictures are not linear.
    is_unlimited_weight : whether each number (n,) is a lobe's weight without an upper bound.
    is_place : whether each number (n,) is a coordinate of a lamp's position or direction.
    scales : how much each number (n,) has to change for other pictures: for places, the distance of
        the lamp from what the cameras see, or a radian; 1 for other numbers.
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
        sensors: list[MitsubaObject] | None = None,
        lighting: Lighting | None = None,
    ) -> None:
        names = tuple(target.name for target in targets)
        self.scene, self.integrator, self.lighting = scene, integrator, lighting
        self.targets, self.parameters, self.unknowns = targets, parameters, unknowns
        self.sensors = sensors or choose_sensors(scene, names, None, lighting is not None)
        self.ends = np.cumsum([len(unknown.start) for unknown in unknowns])
        _check_picture_sizes(self.sensors, targets)
        self.target_pixels = self.join_pictures([target.pixels for target in targets])
        self.weights = self.join_pictures([target.weights for target in targets])
        self.weights /= sum(target.count for target in targets)
        self.counted: BoolArray = np.any(self.weights > 0, axis=1)
        self.blocks = group_pixels_by_block(self.sensors, self.counted)
        self.names = tuple(name for unknown in unknowns for name in unknown.names)
        self.start = np.concatenate([u.to_coordinates(u.start) for u in unknowns])

        def repeat_by_number(values: Iterable[Any]) -> AnyArray:
            """Return one value for each unknown, repeated for each of its numbers: (n,)."""
            return np.repeat(list(values), [len(unknown.start) for unknown in unknowns])

        self.lower_bounds = repeat_by_number(u.limits[0] for u in unknowns)
        self.upper_bounds = repeat_by_number(u.limits[1] for u in unknowns)
        self.is_linear = repeat_by_number(u.is_linear for u in unknowns)
        lamps = {key for keys in find_lamp_keys(parameters).values() for key in keys}
        self.is_lamp = repeat_by_number(u.key in lamps for u in unknowns)
        self.is_nonlinear_share = repeat_by_number(
            u.is_bounded and not u.is_linear for u in unknowns
        )
        self.is_unlimited_weight = repeat_by_number(
            u.model is not None and u.is_linear and not u.is_bounded for u in unknowns
        )
        self.is_place = repeat_by_number(u.is_place for u in unknowns)
        sight = find_sight(self.sensors, scene) if self.is_place.any() else None
        self.scales = repeat_by_number(u.find_scale(sight) for u in unknowns)
        self.has_wrong_derivatives = repeat_by_number(u.has_wrong_derivatives for u in unknowns)
        everywhere = list(range(len(targets)))
        lit = [lighting.find_pictures_lit_by(u.key) if lighting else None for u in unknowns]
        self._changed = [everywhere if own is None else own for own in lit]
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

    def pick_pictures(self, most: int) -> "Views":
        """Return the `Views` of at most so many of the pictures, evenly spread, of the same scene.

        Without lights by picture these are the `Views` themselves.
        """
        if self.lighting is None or len(self.targets) <= most:
            return self
        numbers = np.linspace(0, len(self.targets) - 1, most).round().astype(int).tolist()
        return Views(
            self.scene,
            self.integrator,
            [self.targets[i] for i in numbers],
            self.parameters,
            self.unknowns,
            [self.sensors[i] for i in numbers],
            self.lighting.pick_pictures(numbers),
        )

    def find_changed_pictures(self, numbers: Sequence[int]) -> list[int]:
        """Return which pictures may change with the searched `numbers`: those that a lamp lights.

        A number that belongs to no lamp may change all pictures.
        """
        unknowns = {int(np.searchsorted(self.ends, number, "right")) for number in numbers}
        return sorted({picture for unknown in unknowns for picture in self._changed[unknown]})

    def render_residuals(self, x: FloatArray, spp: int, seed: int) -> FloatArray:
        """Return rendered minus target pixels (pixels, channels) at `x`, with `spp` samples."""
        return self.render_pixels(x, spp, seed) - self.target_pixels

    def render_pixels(
        self, x: FloatArray, spp: int, seed: int, numbers: Sequence[int] | None = None
    ) -> FloatArray:
        """Return rendered pixels (pixels, channels) at `x`, with `spp` samples.

        Only the pictures with the given `numbers` are rendered; the others are 0.
        """
        pictures = self.make_black_pictures()
        numbers = range(len(pictures)) if numbers is None else numbers
        self.cost += spp * len(numbers) / len(pictures)
        with raise_first_cause():
            for i in numbers:
                if self.lighting or i == numbers[0]:
                    self.write_to_scene(x, i)
                pictures[i] = self.integrator.render(
                    self.scene, sensor=self.sensors[i], seed=int(seed) + i, spp=int(spp)
                )
            return self.join_pictures(pictures)

    def make_black_pictures(self) -> list[Any]:
        """Return a black picture (height, width, channels) for each target."""
        return [np.zeros(target.pixels.shape) for target in self.targets]

    def split_pictures(self, pixels: AnyArray) -> list[AnyArray]:
        """Return pixels (pixels, channels) as pictures (height, width, channels)."""
        pictures = []
        for target in self.targets:
            count = np.prod(target.size)
            pictures.append(pixels[:count].reshape(target.pixels.shape))
            pixels = pixels[count:]
        return pictures

    def join_pictures(self, pictures: Iterable[Any]) -> FloatArray:
        """Return pictures, one for each target, as pixels (pixels, channels) of all of them."""
        arrays = [np.array(picture, float) for picture in pictures]
        channels = self.targets[0].pixels.shape[2]
        films = {min(a.shape[2], 3) for a in arrays}
        if films != {channels}:
            raise BrdfkitError(
                f"the pictures have {channels} channel{'s' * (channels > 1)}, and a camera's film "
                f"{min(films - {channels})}: they should have as many."
            )
        return np.concatenate([a[..., :channels].reshape(-1, channels) for a in arrays])

    def write_to_scene(self, x: FloatArray, picture: int | None = None) -> None:
        """Write the values at the search coordinates `x` into the scene, lit as in a picture.

        `picture` is the picture's number; if it is None, all lamps burn.
        """
        self.write_entries(self.make_entries(x), picture)

    def make_entries(self, x: FloatArray) -> list[MitsubaObject]:
        """Return the values at `x` as Mitsuba's arrays, tensors or transforms, one per unknown."""
        entries = []
        for unknown, values in zip(self.unknowns, self.to_values(x), strict=True):
            if unknown.texels is not None:
                entries.append(make_tensor(values, unknown.texels))
            elif unknown.place:
                entries.append(unknown.place.make_transform(unknown.place.to_vector(values)))
            else:
                entries.append(make_opaque_array(type(self.parameters[unknown.key]), values))
        return entries

    def write_entries(self, entries: list[MitsubaObject], picture: int | None = None) -> None:
        """Write Mitsuba's arrays, tensors or transforms, one per unknown, into the scene."""
        for unknown, entry in zip(self.unknowns, entries, strict=True):
            self.parameters[unknown.key] = entry
        if self.lighting:
            keys = [unknown.key for unknown in self.unknowns]
            self.lighting.switch(picture, dict(zip(keys, entries, strict=True)))
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


def _check_picture_sizes(sensors: list[MitsubaObject], targets: list[Target]) -> None:
    """Raise `BrdfkitError` unless each target has the size of its sensor's film."""
    for sensor, target in zip(sensors, targets, strict=True):
        width, height = sensor.film().crop_size()
        if (width, height) != target.size:
            raise BrdfkitError(
                f"picture {target.name} has {target.size[0]} × {target.size[1]} pixels, and its "
                f"camera {width} × {height}: they should be of one size."
            )
