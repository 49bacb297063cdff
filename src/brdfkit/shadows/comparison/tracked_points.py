"""Points of a picture that are watched while the camera moves, or while the light does."""

from dataclasses import dataclass
from math import nan

import numpy as np

from brdfkit.shadows.comparison import camera_path, paths
from brdfkit.shadows.comparison.exact_shadow import Seen
from brdfkit.shadows.comparison.quality import flicker
from brdfkit.shadows.maps.placement import Placement

EVERY = 7  # of the pixels one is watched


@dataclass(frozen=True)
class Watched:
    """Points that keep their places in the world.

    seen : the first picture.
    pixels : those of it where the points are.
    path : where the camera and the light are in each picture, from the first one on.
    true : whether (pictures, points) the light arrives.
    """

    seen: Seen
    pixels: np.ndarray
    path: list[Placement]
    true: np.ndarray

    @classmethod
    def by_moving_camera(cls, seen, placement):
        """Points that all cameras of a path see; their light stands still."""
        path, pixels = camera_path.path(placement), np.flatnonzero(seen.facing)[::EVERY]
        pixels = pixels[camera_path.seen_by_all(path, np.array(seen.si.p).T[pixels])]
        return cls(seen, pixels, path, np.tile(seen.exact[pixels], (len(path), 1)))

    @classmethod
    def by_moving_light(cls, seen, placement):
        """Points that face all lights of a path; their camera stands still."""
        path, pixels = paths.path(placement), np.flatnonzero(seen.facing)[::EVERY]
        p, n = (np.array(vectors).T[pixels] for vectors in (seen.si.p, seen.si.n))
        pixels = pixels[paths.faced_by_all(path, p, n)]
        p, n = seen.points(pixels)
        true = [paths.arrives(seen.scene, each.light, p, n) for each in path]
        return cls(seen, pixels, path, np.array(true))

    def flicker(self, lit, shadow_of):
        """The mean change of a technique's error from picture to picture; nan of no points.

        lit : the shares (pixels,) of the light that arrive in the first picture, by the technique.
        shadow_of : the function (seen, placement) → what has `lit(p, n)`, as `LightShadow`.
        """
        if not self.pixels.size:
            return nan
        p, n = self.seen.points(self.pixels)
        later = [np.array(shadow_of(self.seen, each).lit(p, n)) for each in self.path[1:]]
        return flicker([lit[self.pixels], *later], self.true)
