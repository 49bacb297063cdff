"""Checks the photographs, cameras and lights of a `Capture`."""

from typing import Any

import numpy as np

from brdfkit.core.arguments import to_array
from brdfkit.core.errors import BrdfkitError
from brdfkit.inverse.photographs.capture.pinhole import Pinhole, find_corners

SMALLEST_SAMPLE = 8  # fewest pixels along the sample's longer side in a photograph


def check_capture(capture: Any) -> None:
    """Convert the fields of a new `Capture` to arrays, and raise `BrdfkitError` for wrong ones."""
    _set_field(capture, "pictures", to_array("pictures", capture.pictures))
    shape, count = capture.pictures.shape, len(np.atleast_1d(capture.pictures))
    if len(shape) != 4 or shape[3] != 3 or not capture.pictures.size:
        raise BrdfkitError(f"pictures: their shape {shape} should be (lights, height, width, 3).")
    for name in ("positions", "intensities"):
        _set_field(capture, name, to_array(name, getattr(capture, name), (count, 3)))
    size = to_array("size", capture.size, (2,))
    if not (size > 0).all():
        raise BrdfkitError("size: the sample's width and height should be above 0 [m].")
    _set_field(capture, "size", tuple(size.tolist()))
    _set_field(capture, "names", tuple(map(str, capture.names)))
    if len(capture.names) != count or len(set(capture.names)) != count:
        raise BrdfkitError(f"names: there should be {count}, one for each picture, all different.")
    if capture.lost is not None:
        _set_field(capture, "lost", np.asarray(capture.lost, bool))
        if capture.lost.shape != shape:
            raise BrdfkitError(
                f"lost: its shape {capture.lost.shape} should be that of the pictures, {shape}."
            )
    _check_pictures(capture)
    _check_lights(capture)
    _check_cameras(capture, count)


def _set_field(capture: Any, name: str, value: object) -> None:
    """Set a field of a `Capture`, which is frozen."""
    object.__setattr__(capture, name, value)


def _check_pictures(capture: Any) -> None:
    """Raise `BrdfkitError` for photographs with values that are not finite."""
    for name, picture in zip(capture.names, capture.pictures, strict=True):
        if not np.isfinite(picture).all():
            bad = int((~np.isfinite(picture)).any(axis=2).sum())
            raise BrdfkitError(f"{name}: {bad:,} of its pixels are not finite.")


def _check_lights(capture: Any) -> None:
    """Raise `BrdfkitError` for lights behind the sample, and for lights without intensity."""
    for name, position in zip(capture.names, capture.positions, strict=True):
        if not position[2] > 0:
            raise BrdfkitError(
                f"{name}: its light is at z = {position[2]:g} m, behind the sample; z should be "
                "above 0."
            )
    if (capture.intensities < 0).any() or not (capture.intensities > 0).any(axis=1).all():
        raise BrdfkitError("intensities: each light needs one above 0, and none below.")


def _check_cameras(capture: Any, count: int) -> None:
    """Raise `BrdfkitError` unless one or `count` cameras are above the sample and see all of it."""
    value = capture.camera
    if not isinstance(value, Pinhole | tuple | list) or not all(
        isinstance(camera, Pinhole) for camera in capture.cameras
    ):
        raise BrdfkitError("camera: it should be a Pinhole, or a tuple of them.")
    if len(capture.cameras) != count:
        raise BrdfkitError(
            f"camera: there are {len(capture.cameras)} for {count} pictures; give one for all, or "
            "one for each."
        )
    for name, camera in zip(capture.names, capture.cameras, strict=True):
        if not camera.origin[2] > 0:
            raise BrdfkitError(
                f"{name}: its camera is at z = {camera.origin[2]:g} m, behind the sample; z should "
                "be above 0."
            )
        _check_corners(capture, name, camera)


def _check_corners(capture: Any, name: str, camera: Pinhole) -> None:
    """Raise `BrdfkitError` unless a picture contains the sample's corners, 8 pixels apart or more.

    `name` is the picture's name, for errors.
    """
    width, height = capture.picture_size
    places = camera.project(find_corners(capture.size), (width, height))
    inside = (places >= -1) & (places <= np.array([width, height]) + 1)
    if inside.all() and np.ptp(places, axis=0).max() < SMALLEST_SAMPLE:
        raise BrdfkitError(
            f"{name}: the sample is smaller than {SMALLEST_SAMPLE} pixels; check that its size and "
            "the place of the camera are both in metres."
        )
    if not inside.all():
        raise BrdfkitError(
            f"{name}: its camera does not see all four corners of the sample; check its place, its "
            "target, its fov, and the sample's width and height in metres."
        )
