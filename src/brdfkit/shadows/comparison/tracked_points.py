"""Points of a picture that are tracked while the camera moves, or while the light does."""

from collections.abc import Callable
from dataclasses import dataclass
from math import nan
from typing import Any

import numpy as np

from brdfkit.core.array_types import AnyArray, FloatArray
from brdfkit.shadows.comparison import paths
from brdfkit.shadows.comparison.exact_shadow import LitView
from brdfkit.shadows.comparison.quality import flicker
from brdfkit.shadows.maps.placement import Placement

PIXEL_STRIDE = 7  # every seventh pixel is tracked


@dataclass(frozen=True)
class TrackedPoints:
    """Points that keep their places in the world.

    view : the first picture.
    pixels : the indices of its pixels where the points are.
    path : the placements of camera and light in each picture, from the first one on.
    true : whether (pictures, points) the light arrives.
    """

    view: LitView
    pixels: AnyArray
    path: list[Placement]
    true: AnyArray

    @classmethod
    def by_moving_camera(cls, view: LitView, placement: Placement) -> "TrackedPoints":
        """Return points that all cameras of a path see; their light stands still."""
        path, pixels = paths.camera_path(placement), np.flatnonzero(view.facing)[::PIXEL_STRIDE]
        pixels = pixels[paths.is_visible_to_all(path, np.array(view.si.p).T[pixels])]
        return cls(view, pixels, path, np.tile(view.exact[pixels], (len(path), 1)))

    @classmethod
    def by_moving_light(cls, view: LitView, placement: Placement) -> "TrackedPoints":
        """Return points that face all lights of a path; their camera stands still."""
        path, pixels = paths.light_path(placement), np.flatnonzero(view.facing)[::PIXEL_STRIDE]
        points, normals = (np.array(vectors).T[pixels] for vectors in (view.si.p, view.si.n))
        pixels = pixels[paths.is_facing_all(path, points, normals)]
        p, n = view.points(pixels)
        true = [paths.is_lit(view.scene, each.light, p, n) for each in path]
        return cls(view, pixels, path, np.array(true))

    def flicker(self, lit: FloatArray, technique: Callable[[LitView, Placement], Any]) -> float:
        """Return the mean change of a technique's error between pictures; NaN without points.

        lit : the shares (pixels,) of the light in the first picture, by the technique.
        technique : makes a shadow, which has `lit_share(p, n)`, as `LightShadow`.
        """
        if not self.pixels.size:
            return nan
        p, n = self.view.points(self.pixels)
        later = [np.array(technique(self.view, each).lit_share(p, n)) for each in self.path[1:]]
        return flicker([lit[self.pixels], *later], self.true)
