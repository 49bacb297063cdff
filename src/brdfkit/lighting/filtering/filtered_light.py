"""`FilteredLight`: the filtered light of an environment emitter, updated when that changes."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Mapping
from math import inf
from typing import Any, Protocol

import numpy as np

from brdfkit.core.array_types import (
    FloatArray,
    JitColour,
    JitFloat,
    JitInt,
    JitVector,
    MitsubaObject,
)
from brdfkit.core.quasi_random import draw_halton_points
from brdfkit.lighting.filtering.emitter_radiance import make_radiance_function
from brdfkit.lighting.filtering.filtered_map import FilteredMap, LobeMaps, Mips
from brdfkit.lighting.filtering.light_filtering import LightFiltering
from brdfkit.mitsuba_bridge.arrays import Rows

# number of directions drawn by an emitter that are tested for shadows of the irradiance
LIGHT_DIRECTIONS = 256
FILTERS: dict[str, type[LobeMaps | Mips]] = {"lobes": LobeMaps, "mips": Mips}


class Light(Protocol):
    """The look-ups by which a filtered environment lights surfaces; colours are linear sRGB."""

    def mean_radiance_over_lobe(self, axis: JitVector, kappa: JitFloat) -> JitColour:
        """Return the mean radiance over a von Mises-Fisher lobe of concentration `kappa`."""

    def irradiance(self, normal: JitVector) -> JitColour:
        """Return the irradiance divided by π: the radiance of a white matte surface."""


class FilteredLight:
    """The light of an environment emitter, filtered for look-ups: means over lobes, and irradiance.

    `kind` is one of the classes in `FILTERS`, which store means over lobes, and `side` the size of
    the filtered map's finest level [texels]. Who knows that the emitter never changes but turns
    sets `only_turns`, so that a large map is not compared before every picture, and is filtered
    once for all lobes.
    """

    def __init__(self, kind: type[LobeMaps | Mips], side: int) -> None:
        self.kind, self.side = kind, side
        # the filtered emitter, and a digest of its parameters
        self.source: tuple[MitsubaObject, bytes] | None = None
        self.sharpest = inf  # the largest concentration κ of the lobes for which it was filtered
        # The emitter's axes, when it was filtered and now
        self.filtered_axes: FloatArray = np.eye(3)
        self.axes: FloatArray = np.eye(3)
        self.directions: LightDirections | None = None
        self.only_turns = False
        # What was begun before it is needed, and the axes of its emitter
        self.begun: tuple[LightFiltering, tuple[MitsubaObject, bytes], FloatArray] | None = None

    @property
    def is_filtered(self) -> bool:
        """Whether an emitter was filtered, or the thread that `begin` has started is at its end."""
        return self.source is not None or (self.begun is not None and self.begun[0].done)

    def begin(self, emitter: MitsubaObject) -> None:
        """Begin to filter the first emitter in a thread, for `filter_if_changed`.

        The emitter may turn meanwhile.
        """
        if self.source is None:
            source, axes = self._describe_emitter(emitter)
            filtering = LightFiltering(make_radiance_function(emitter), self.kind, self.side, inf)
            self.begun = filtering, source, axes
            filtering.begin()

    def filter_if_changed(
        self, emitter: MitsubaObject, find_sharpest: Callable[[], float] = lambda: inf
    ) -> FilteredLight:
        """Filter the `emitter` unless it is unchanged since the last call; return this object.

        If it has only turned, look-ups are turned instead, without a new kernel. `find_sharpest`
        returns the largest concentration κ of the lobes that are looked up, so that the finest
        levels, which take longest, are first filtered when they are needed.
        """
        source, axes = self._describe_emitter(emitter)
        turn = _find_turn(self.filtered_axes, axes)
        if self.source != source or turn is None:
            turn = self._filter(source, axes, inf if self.only_turns else find_sharpest())
        elif self.sharpest < inf and find_sharpest() > self.sharpest:
            turn = self._filter(source, axes, inf)
        elif np.array_equal(axes, self.axes):
            return self
        self._turn_look_ups(axes, turn)
        return self

    def _filter(
        self, source: tuple[MitsubaObject, bytes], axes: FloatArray, sharpest: float
    ) -> FloatArray:
        """Filter an emitter with these axes for lobes up to κ = `sharpest`; return its turn since.

        It has turned if it was begun before.
        """
        filtering, before = self._find_filtering(source, axes, sharpest)
        levels, irradiance = filtering.finish()
        self.lobes, self.irradiances = self.kind(levels), FilteredMap([irradiance])
        self.source, self.filtered_axes, self.begun = source, before, None
        self.sharpest = filtering.sharpest
        turn = _find_turn(before, axes)
        assert turn is not None, "it was begun with axes that are only turned by now"
        return turn

    def _describe_emitter(
        self, emitter: MitsubaObject
    ) -> tuple[tuple[MitsubaObject, bytes], FloatArray]:
        """Return the emitter with a digest of its parameters, and its axes (3, 3)."""
        import mitsuba as mi

        parameters = mi.traverse(emitter)
        digest = b"" if self.only_turns else _digest_parameters(parameters)
        return (emitter, digest), _find_axes(parameters)

    def _find_filtering(
        self, source: tuple[MitsubaObject, bytes], axes: FloatArray, sharpest: float
    ) -> tuple[LightFiltering, FloatArray]:
        """Return what was begun of an emitter, or begin now; and the emitter's axes at that time.

        If it begins now, it is for lobes of a concentration up to `sharpest`.
        It was begun in vain if the emitter has done more than turn since.
        """
        if self.begun is not None:
            filtering, begun, before = self.begun
            if begun == source and _find_turn(before, axes) is not None:
                return filtering, before
        radiance = make_radiance_function(source[0])
        return LightFiltering(radiance, self.kind, self.side, sharpest), axes

    def _turn_look_ups(self, axes: FloatArray, turn: FloatArray) -> None:
        """Turn the directions of look-ups by a matrix (3, 3), for an emitter with these axes."""
        import drjit as dr
        import mitsuba as mi

        self.axes, self.turn, self.directions = axes, mi.Matrix3f(turn.tolist()), None
        dr.make_opaque(self.turn)

    def get_light_directions(self, rays: int) -> LightDirections:
        """Return directions drawn by the emitter, shared by the `rays` of a pixel, for shadows."""
        if self.directions is None or self.directions.rays != rays:
            assert self.source is not None, "call filter_if_changed first"
            self.directions = LightDirections(self.source[0], LIGHT_DIRECTIONS, rays)
        return self.directions

    def mean_radiance_over_lobe(self, axis: JitVector, kappa: JitFloat) -> JitColour:
        """Return the mean radiance, in linear sRGB, over a lobe of concentration `kappa`."""
        return self.lobes.mean_over_lobe(self.turn @ axis, kappa)

    def irradiance(self, normal: JitVector) -> JitColour:
        """Return the irradiance for this `normal` divided by π, in linear sRGB."""
        return self.irradiances.interpolate_bilinearly(self.turn @ normal, 0)


class LightDirections:
    """At least `count` directions drawn by an `emitter`, to test from where its light is visible.

    Brighter parts of the environment have more directions. They are always the same ones, and are
    shared out among the `rays` of a pixel.
    """

    def __init__(self, emitter: MitsubaObject, count: int, rays: int) -> None:
        import drjit as dr
        import mitsuba as mi

        self.rays, self.per_ray = rays, -(-count // rays)
        # Points of Halton's sequence are evenly spread, even a few consecutive ones as each ray
        # takes
        u = draw_halton_points(1 + rays * self.per_ray, 2, None)[1:].astype(np.float32)
        origin = dr.zeros(mi.SurfaceInteraction3f, len(u))
        drawn, _ = emitter.sample_direction(origin, mi.Point2f(u.T))
        directions, density = np.array(drawn.d).T, np.array(drawn.pdf)[:, None]
        self.directions = Rows(directions)
        self.powers = Rows(make_radiance_function(emitter)(directions) / density)

    def get_direction(self, i: JitInt, ray: JitInt) -> tuple[JitVector, JitColour]:
        """Return direction `i` of a ray, and its radiance divided by the density of drawing it."""
        import mitsuba as mi

        place = ray * self.per_ray + i
        return self.directions.at(place, mi.Vector3f), self.powers.at(place, mi.Color3f)


def _find_axes(parameters: Mapping[str, Any]) -> FloatArray:
    """Return the axes (3, 3) of an emitter in the scene, as columns, from its parameters."""
    if "to_world" not in parameters:
        return np.eye(3)
    return np.array(parameters["to_world"].matrix, float).reshape(4, 4)[:3, :3]


def _find_turn(before: FloatArray, after: FloatArray) -> FloatArray | None:
    """Return the matrix (3, 3) by which look-ups turn if axes change from `before` to `after`.

    It is None if the axes are not only turned.
    """
    if np.array_equal(before, after):
        return np.eye(3)
    turn: FloatArray = before @ np.linalg.inv(after)
    return turn if np.allclose(turn @ turn.T, np.eye(3), atol=1e-5) else None


def _digest_parameters(parameters: Mapping[str, Any]) -> bytes:
    """Return a digest of an emitter's parameters, by which changes are noticed, but turns are not.

    `parameters` are what `mitsuba.traverse` finds.
    """
    digest = hashlib.blake2b()
    for name in sorted(parameters.keys()):
        if name == "to_world":
            continue
        value = parameters[name]
        text = np.array(value).tobytes() if hasattr(value, "__len__") else str(value).encode()
        digest.update(name.encode() + text)
    return digest.digest()
