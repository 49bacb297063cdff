"""Photographs made smaller where the maps do not need all of their pixels."""

from dataclasses import replace

import numpy as np

PER_TEXEL = 1.4  # pixels along a side of a texel, at least


def shrunk(capture, shape):
    """A `Capture` with means of pixels in place of pixels, as few as maps of a `shape` need.

    Blocks have odd sides, so that the same number of pixels may be added left and right.
    """
    height, width = shape
    texel = np.array(capture.size) / (width, height)
    pixel = np.max([capture.pixel(camera) for camera in capture.cameras], axis=0)
    side = int((texel / pixel).min() / PER_TEXEL)
    side -= (side + 1) % 2
    if side < 2:
        return capture
    wide = _padding(capture.picture_size[0], side)
    high = _padding(capture.picture_size[1], side)
    around = (0, 0), (high, high), (wide, wide), (0, 0)
    lost = np.pad(capture.left_out, around, constant_values=True)
    pictures = np.pad(capture.pictures, around)
    scale = pictures.shape[2] / capture.picture_size[0]
    cameras = [replace(camera, fov=_wider(camera.fov, scale)) for camera in capture.cameras]
    return replace(
        capture,
        pictures=_blocks(pictures, side).mean(axis=(2, 4)),
        lost=_blocks(lost, side).any(axis=(2, 4)),
        camera=cameras[0] if len(set(map(id, capture.cameras))) == 1 else tuple(cameras),
    )


def _padding(pixels, side):
    """How many pixels are added at each end, for the sum to be a multiple of an odd `side`."""
    return next(n for n in range(side) if (pixels + 2 * n) % side == 0)


def _wider(fov, scale):
    """The angle [degrees] across a picture that is `scale` times as wide."""
    return float(2 * np.degrees(np.arctan(scale * np.tan(np.radians(fov) / 2))))


def _blocks(values, side):
    """Pictures (k, rows, side, columns, side, channels)."""
    lights, height, width, channels = values.shape
    return values.reshape(lights, height // side, side, width // side, side, channels)
