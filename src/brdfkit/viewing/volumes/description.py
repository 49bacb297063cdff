"""Describes a volume for the page: the message "open", and the box over the picture."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from brdfkit.viewing.camera import Camera
from brdfkit.viewing.volumes import saving
from brdfkit.viewing.volumes.histograms import make_histograms
from brdfkit.viewing.volumes.state import list_controls
from brdfkit.viewing.volumes.volume_controls import PANELS
from brdfkit.volumes import Volume
from brdfkit.volumes.orientation import LETTERS, name_ends

if TYPE_CHECKING:
    from brdfkit.viewing.application import Message

    Application = Any  # `VolumeApplication`, which imports this file


def describe_volume(application: Application) -> Message:
    """Return the message "open": the panels, the controls, the volume and its histograms."""
    volume, states = application.volume, application.states
    live = states.live
    counts, joint = make_histograms(volume, (live.low, live.high), live.steepest)
    return {
        "title": volume.name,
        "parts": ["camera", "paint", "transfer", "slices"],
        "panels": [
            {"name": name, "label": label, "open": is_open} for name, label, is_open in PANELS
        ],
        "controls": list_controls(states.controls),
        "volume": {
            "size": volume.size,
            "spacing": volume.spacing,
            "unit": volume.unit,
            "value_unit": states.value_unit,
            "range": [live.low, live.high],
            "steepest": live.steepest,
            "axes": volume.axes,
            "axis_names": _name_axes(volume),
        },
        "histogram": counts,
        "presets": states.functions.names(),
        "saves": [{"kind": kind, "label": label} for kind, label in saving.KINDS.items()],
    }, [joint]


def _name_axes(volume: Volume) -> list[str]:
    """Return the names of the grid's axes, which of a patient say where they start and end."""
    if volume.axes != "RAS":
        return list("xyz")
    return ["–".join(ends).capitalize() for ends in name_ends(volume)]


def describe_box(volume: Volume, camera: Camera, aspect: float) -> dict[str, Any]:
    """Return the places of the box's corners in the picture, its size, and its ends' names.

    `aspect` is the picture's width over its height. "across" is the length across the picture's
    shorter side at the camera's target.
    """
    corners = np.stack(np.meshgrid([0, 1], [0, 1], [0, 1], indexing="ij"), -1).reshape(-1, 3)
    to_world = volume.cube_to_world
    points = corners @ to_world[:3, :3].T + to_world[:3, 3]
    edges = np.linalg.norm(to_world[:3, :3], axis=0)
    ends = name_ends(volume, LETTERS) if volume.axes == "RAS" else ()
    return {
        "corners": np.round(camera.project(points, aspect), 5).tolist(),
        "size": [f"{edge:.4g} {volume.unit}".strip() for edge in edges],
        "ends": [letter for pair in ends for letter in pair],
        "across": 2 * camera.distance * float(np.tan(np.radians(camera.fov / 2))),
    }
