"""`FilteredLight`: the light of an environment emitter, filtered once and again when it changes."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
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
from brdfkit.core.jit.padding import pad
from brdfkit.lighting.filtering.filtered_map import FilteredMap, LobeMaps, Mips, make_picture
from brdfkit.lighting.filtering.paraboloid_levels import to_discs
from brdfkit.lighting.filtering.sphere_filter import convolve, halve
from brdfkit.mitsuba_bridge.arrays import Rows

IRRADIANCE_SIDE = 64  # texels: irradiance is smooth
WAVELENGTHS = 96  # evenly spaced, at which a spectral variant is evaluated
LIGHT_DIRECTIONS = 256  # that represent all the light where it may be hidden
FILTERS: dict[str, type[LobeMaps | Mips]] = {"lobes": LobeMaps, "mips": Mips}


class Light(Protocol):
    """Filtered light as surfaces look it up, in linear sRGB."""

    def mean_over_lobe(self, axis: JitVector, kappa: JitFloat) -> JitColour:
        """Return the mean radiance over the von Mises-Fisher lobe of this axis and κ."""

    def irradiance(self, normal: JitVector) -> JitColour:
        """Return the irradiance divided by π: the radiance of a white matte surface."""


class FilteredLight:
    """The light of an environment: its means over lobes, and its irradiance over normals.

    `kind` is one of `FILTERS`, and `side` the size of the map's finest level [texels].
    """

    def __init__(self, kind: type[LobeMaps | Mips], side: int) -> None:
        self.kind, self.side = kind, side
        self.source: tuple[MitsubaObject, bytes] | None = None  # the emitter, and its digest
        self.directions: LightDirections | None = None

    def update(self, emitter: MitsubaObject) -> FilteredLight:
        """Filter the `emitter` unless it is unchanged since the last call; return this object."""
        source = emitter, _digest(emitter)
        if self.source != source:
            radiance = radiance_function(emitter)
            picture = make_picture(radiance, self.side)
            self.lobes = self.kind(radiance, picture)
            self.irradiances = FilteredMap([filter_irradiance(picture)])
            self.source, self.directions = source, None
        return self

    def light_directions(self, rays: int) -> LightDirections:
        """Return the directions from which the light comes, shared by the `rays` of a pixel."""
        if self.directions is None or self.directions.rays != rays:
            assert self.source is not None, "call update first"
            self.directions = LightDirections(self.source[0], LIGHT_DIRECTIONS, rays)
        return self.directions

    def mean_over_lobe(self, axis: JitVector, kappa: JitFloat) -> JitColour:
        """Return the mean radiance over a von Mises-Fisher lobe, linear sRGB."""
        return self.lobes.at(axis, kappa)

    def irradiance(self, normal: JitVector) -> JitColour:
        """Return the radiance of a white matte surface of this `normal`, linear sRGB."""
        return self.irradiances.bilinear(normal, 0)


class LightDirections:
    """At least `count` directions drawn by an `emitter`, the same ones every time.

    Brighter light has more of them. They are dealt out to the `rays` of a pixel.
    """

    def __init__(self, emitter: MitsubaObject, count: int, rays: int) -> None:
        import drjit as dr
        import mitsuba as mi
        from scipy.stats import qmc

        self.rays, self.per_ray = rays, -(-count // rays)
        # Any consecutive points of Halton's sequence, such as those of a ray, are spread out
        u = qmc.Halton(2, scramble=False).random(1 + rays * self.per_ray)[1:].astype(np.float32)
        origin = dr.zeros(mi.SurfaceInteraction3f, len(u))
        drawn, _ = emitter.sample_direction(origin, mi.Point2f(u.T))
        directions, density = np.array(drawn.d).T, np.array(drawn.pdf)[:, None]
        self.directions = Rows(directions)
        self.powers = Rows(radiance_function(emitter)(directions) / density)

    def at(self, i: JitInt, ray: JitInt) -> tuple[JitVector, JitColour]:
        """Return direction `i` of a ray, and the radiance from it over its density, linear sRGB."""
        import mitsuba as mi

        place = ray * self.per_ray + i
        return self.directions.at(place, mi.Vector3f), self.powers.at(place, mi.Color3f)


def filter_irradiance(picture: FloatArray) -> FloatArray:
    """Return the irradiance divided by π for all normals, from the radiance of all directions.

    `picture` is (height, 2 height, channels) by latitude and longitude. The result is a pair of
    discs (2, IRRADIANCE_SIDE, IRRADIANCE_SIDE, channels).
    """
    while len(picture) > 4 * IRRADIANCE_SIDE:
        picture = halve(picture)
    irradiance = convolve(picture, lambda cos: np.maximum(cos, 0) / np.pi, np.pi / 2)
    return to_discs(irradiance, IRRADIANCE_SIDE)


def radiance_function(emitter: MitsubaObject) -> Callable[[FloatArray], FloatArray]:
    """Return a function of unit vectors (n, 3) → radiance (n, 3) from there, linear sRGB."""
    import drjit as dr
    import mitsuba as mi

    def radiance(directions: FloatArray) -> FloatArray:
        si = dr.zeros(mi.SurfaceInteraction3f, len(directions))
        towards = np.ascontiguousarray(-directions.T, np.float32)
        si.wi = mi.Vector3f(*(pad(component) for component in towards))
        if mi.is_spectral:
            value = _integrate_spectrum(emitter, si)
        else:
            value = np.array(mi.unpolarized_spectrum(emitter.eval(si)), float).T
        # Uniform light has one value for all directions, grey light one for all channels
        return np.broadcast_to(value, (len(directions), 3))

    return radiance


def _integrate_spectrum(emitter: MitsubaObject, si: MitsubaObject) -> FloatArray:
    """Return the radiance (n, 3) of an emitter's spectrum at `si`, linear sRGB."""
    import mitsuba as mi

    first, last = float(mi.MI_CIE_MIN), float(mi.MI_CIE_MAX)
    each = len(si.wavelengths)
    wavelengths = first + (np.arange(WAVELENGTHS) + 0.5) / WAVELENGTHS * (last - first)
    total: Any = 0.0
    for few in wavelengths.reshape(-1, each):
        si.wavelengths = type(si.wavelengths)(*few.tolist())
        value = mi.unpolarized_spectrum(emitter.eval(si))
        total = total + np.array(mi.spectrum_to_srgb(value, si.wavelengths), float).T
    return total * (last - first) / (WAVELENGTHS // each)


def _digest(emitter: MitsubaObject) -> bytes:
    """Return a digest of the parameters of an `emitter`, to notice when it changes."""
    import mitsuba as mi

    parameters = mi.traverse(emitter)
    digest = hashlib.blake2b()
    for name in sorted(parameters.keys()):
        value = parameters[name]
        text = np.array(value).tobytes() if hasattr(value, "__len__") else str(value).encode()
        digest.update(name.encode() + text)
    return digest.digest()
