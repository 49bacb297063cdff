"""Keeps the state of an interrupted fit of an object in a file, and finds it again."""

from __future__ import annotations

import hashlib
from dataclasses import fields
from pathlib import Path
from zipfile import BadZipFile

import numpy as np

from brdfkit.core.errors import BrdfkitError
from brdfkit.core.files import write_safely
from brdfkit.inverse.photographs.capture.object_capture import ObjectCapture
from brdfkit.inverse.photographs.maps.texel_parameters import TexelParameters
from brdfkit.inverse.photographs.objects.calibration import Calibration
from brdfkit.inverse.photographs.objects.fit_object import FittedObject
from brdfkit.inverse.photographs.objects.tile import split_into_tiles

NAME = "unfinished.npz"
EVERY = 97  # only every such pixel enters the checksum of photographs, which is fast
SHARED = "shared_"  # prefix of the calibration's entries


def save_state(
    folder: Path, state: FittedObject, capture: ObjectCapture, parameters: TexelParameters
) -> Path:
    """Write the state of a fit to a file in a folder, and return its path."""
    path, known = folder / NAME, state.calibration
    assert known is not None
    content = {
        field.name: getattr(state, field.name)
        for field in fields(state)
        if field.name != "calibration"
    }
    content |= {
        SHARED + field.name: getattr(known, field.name)
        for field in fields(known)
        if field.name not in ("parameters", "shapes")
    }
    content[SHARED + "shapes"] = np.array(list(known.shapes.values()))
    content["checksum"] = compute_checksum(capture, parameters)
    with write_safely(path) as beside:
        np.savez(beside, **content)
    return path


def load_state(
    folder: Path, capture: ObjectCapture, parameters: TexelParameters
) -> FittedObject | None:
    """Return the state in a folder, or None if there is none of this fit."""
    path = folder / NAME
    if not path.is_file():
        return None
    try:
        with path.open("rb") as stream, np.load(stream) as content:
            stored = {name: content[name] for name in content.files}
        if str(stored["checksum"]) != compute_checksum(capture, parameters):
            return None
        names = (*parameters.names, *parameters.fixed)
        known = Calibration(
            parameters=parameters,
            shapes=dict(zip(names, stored[SHARED + "shapes"].tolist(), strict=True)),
            exposures=stored[SHARED + "exposures"],
            dark_offset=float(stored[SHARED + "dark_offset"]),
            noise=float(stored[SHARED + "noise"]),
            usual_weights=stored[SHARED + "usual_weights"],
            spreads=stored[SHARED + "spreads"],
        )
        return FittedObject(
            calibration=known,
            normals=stored["normals"],
            weights=stored["weights"],
            normal_errors=stored["normal_errors"],
            weight_errors=stored["weight_errors"],
            lights=stored["lights"],
            expected_normals=stored["expected_normals"],
            finished=int(stored["finished"]),
        )
    except (OSError, ValueError, KeyError, EOFError, BadZipFile) as error:
        raise BrdfkitError(f"{path}: it is damaged; delete it to begin again.") from error


def compute_checksum(capture: ObjectCapture, parameters: TexelParameters) -> str:
    """Return a checksum of photographs, their lights and a model, to which a state belongs."""
    model = parameters.model
    words = model.type_name(), model.changed_options(), sorted(parameters.fixed.items())
    pixels = capture.values.shape[1]
    tiles = len(split_into_tiles(pixels, len(capture.lights)))
    places = capture.pixel_size, capture.distance, tiles
    digest = hashlib.sha256(repr((words, capture.names, places)).encode())
    lights = (getattr(capture.lights, field.name) for field in fields(capture.lights))
    lost = None if capture.lost is None else capture.lost[:, ::EVERY]
    for values in (capture.values[:, ::EVERY], lost, capture.mask, *lights):
        digest.update(b"none" if values is None else np.ascontiguousarray(values).tobytes())
    return digest.hexdigest()
