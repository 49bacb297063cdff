"""Resamples maps: the light of the same directions, in another convention."""

from math import ceil, sqrt

import numpy as np


def resample(pixels, source, target, height, turn=0.0, mirror=False):
    """A map `pixels` (height, width, channels) of one `Convention` in another, `height` rows high.

    `turn` [degrees] turns the light about the up axis, anticlockwise seen from above; `mirror`
    exchanges left and right of the source. Where the target has fewer pixels, it has the mean of
    several places in each of them. Blank pixels are 0.
    """
    width = round(height * target.layout.aspect)
    into = source.frame.T @ _about_y(turn).T @ target.frame  # frame of the target → of the source
    if mirror:
        into = np.diag([-1, 1, 1]) @ into
    finer = max(1, ceil(sqrt(pixels.shape[0] * pixels.shape[1] / (height * width)) - 0.01))
    offsets = (np.arange(finer) + 0.5) / finer - 0.5
    parts = parts_of(source.layout, *pixels.shape[:2])
    total = np.zeros((height, width, pixels.shape[2]))
    count = np.zeros((height, width, 1))
    for dy in offsets:
        for dx in offsets:
            x, y = np.arange(width)[None, :] + dx, np.arange(height)[:, None] + dy
            towards = target.layout.directions(x, y, height, width) @ into.T
            seen = np.isfinite(towards[..., 0])
            total[seen] += look_up(pixels, source.layout, towards[seen], parts)
            count[seen] += 1
    return total / np.maximum(count, 1)


def look_up(pixels, layout, directions, parts=None):
    """The values (n, channels) of a map at `directions` (n, 3) in its frame: bilinear.

    `parts`: the result of `parts_of`, for maps that are looked up several times.
    """
    height, width = pixels.shape[:2]
    parts = parts_of(layout, height, width) if parts is None else parts
    x, y, part = layout.places(directions, height, width)
    left, above = np.floor(x).astype(int), np.floor(y).astype(int)
    total, weights = 0.0, 0.0
    for column, across in ((left, left + 1 - x), (left + 1, x - left)):
        for row, down in ((above, above + 1 - y), (above + 1, y - above)):
            i, j = np.clip(row, 0, height - 1), np.clip(column, 0, width - 1)
            if layout.closed:
                j = column % width
            weight = (across * down * (parts[i, j] == part))[:, None]
            total, weights = total + weight * pixels[i, j], weights + weight
    return total / weights


def parts_of(layout, height, width):
    """The part (height, width) of the picture that each pixel belongs to, -1 where it is blank."""
    x, y = np.arange(width)[None, :], np.arange(height)[:, None]
    towards = layout.directions(x, y, height, width)
    found = np.full((height, width), -1)
    seen = np.isfinite(towards[..., 0])
    found[seen] = layout.places(towards[seen], height, width)[2]
    return found


def _about_y(degrees):
    """The rotation by `degrees` about y: it takes +z to +x by 90."""
    cosine, sine = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    return np.array([[cosine, 0, sine], [0, 1, 0], [-sine, 0, cosine]])
