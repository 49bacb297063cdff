"""Fits the maps of an object, compares them with photographs, and collects the result."""

from __future__ import annotations

import time
from pathlib import Path
from typing import Any

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.interrupts import Interrupted, is_interrupt
from brdfkit.core.progress_bar import Progress, make_step_counter
from brdfkit.inverse.photographs.capture.object_capture import ObjectCapture
from brdfkit.inverse.photographs.maps.texel_parameters import TexelParameters
from brdfkit.inverse.photographs.objects.checks import check_lights_of_fit
from brdfkit.inverse.photographs.objects.equations import Reflection
from brdfkit.inverse.photographs.objects.fit_object import (
    FittedObject,
    estimate_reports,
    fit_object,
)
from brdfkit.inverse.photographs.objects.notes import describe_object_fit
from brdfkit.inverse.photographs.objects.object_maps import ObjectMaps
from brdfkit.inverse.photographs.objects.photometric_stereo import estimate_normals
from brdfkit.inverse.photographs.objects.prediction import predict_photographs
from brdfkit.inverse.photographs.objects.tile import Tile, split_into_tiles
from brdfkit.inverse.photographs.objects.unfinished import NAME, load_state, save_state
from brdfkit.inverse.photographs.result.comparison import Comparison, compute_angles
from brdfkit.model import labels

FEWEST_PHOTOGRAPHS = 3
INTERRUPTED = "Interrupted: these are the maps so far, without standard errors."


def fit_maps_of_object(
    capture: ObjectCapture,
    hidden: ObjectCapture | None,
    label: str,
    parameters: TexelParameters,
    checkpoint: Path | None,
    progress: Progress | None,
) -> ObjectMaps:
    """Return the maps of an object; `hidden` are photographs that are held out.

    `checkpoint` is a folder where an interrupted search keeps its state, and finds it again. On
    Ctrl-C `Interrupted` holds the maps so far; before there are any, it is a KeyboardInterrupt.
    """
    began = time.perf_counter()
    if len(capture.names) < FEWEST_PHOTOGRAPHS:
        raise BrdfkitError(
            f"{capture.name}: {len(capture.names)} photographs of an object are too few to fit; "
            f"its normals need {FEWEST_PHOTOGRAPHS} lights or more."
        )
    check_lights_of_fit(capture)
    report = make_step_counter(progress, estimate_reports(capture, parameters))
    state = None if checkpoint is None else load_state(checkpoint, capture, parameters)
    try:
        state = fit_object(capture, parameters, state, report)
        maps = _collect(capture, hidden, label, state, began)
    except (KeyboardInterrupt, RuntimeError) as stop:
        if not is_interrupt(stop):
            raise
        state = stop.best if isinstance(stop, Interrupted) else state
        notes = _keep_state(checkpoint, state, capture, parameters)
        if state is None or state.calibration is None or not state.finished:
            raise KeyboardInterrupt from None
        maps = _collect(capture, hidden, label, state, began, (INTERRUPTED, *notes))
        raise Interrupted(maps, f"{capture.name}: there are maps so far") from None
    if checkpoint is not None:
        (checkpoint / NAME).unlink(missing_ok=True)
    return maps


def _keep_state(
    checkpoint: Path | None,
    state: FittedObject | None,
    capture: ObjectCapture,
    parameters: TexelParameters,
) -> tuple[str, ...]:
    """Save the state of an interrupted fit, if there is any; return a note if that fails."""
    if checkpoint is None or state is None or state.calibration is None:
        return ()
    try:
        save_state(checkpoint, state, capture, parameters)
    except BrdfkitError as error:
        return (f"The same command begins again, because its state could not be kept: {error}",)
    return ()


def _collect(
    capture: ObjectCapture,
    hidden: ObjectCapture | None,
    label: str,
    state: FittedObject,
    began: float,
    interrupted: tuple[str, ...] = (),
) -> ObjectMaps:
    """Return the result of a search that ended, or was interrupted, which sentences say."""
    known = state.calibration
    assert known is not None
    names = known.parameters.lobes
    maps = {
        name: capture.to_picture(state.weights[:, :, k].astype(np.float32))
        for k, name in enumerate(names)
    }
    upright = np.zeros((*capture.mask.shape, 3), np.float32)
    upright[..., 2] = 1
    upright[capture.mask] = state.normals
    maps["normal"] = upright
    compared = {} if interrupted else _compare(capture, hidden, state)
    fitted = compared.get("fitted_errors")
    by_name = fitted.by_name if fitted else {}
    notes = (
        *interrupted,
        *capture.notes,
        *(() if interrupted else describe_object_fit(capture, state, by_name)),
    )
    return ObjectMaps(
        name=capture.name,
        model=label,
        maps=maps,
        fixed=known.shapes,
        mask=capture.mask,
        uncertainty={} if interrupted else _map_errors(capture, state),
        lights=capture.to_picture(state.lights.astype(np.float32)),
        exposures=dict(zip(capture.names, known.exposures.tolist(), strict=True)),
        noise=known.noise,
        fitted_errors=fitted,
        held_out_errors=compared.get("held_out_errors"),
        lambertian_errors=compared.get("lambertian_errors"),
        normal_error=compared.get("normal_error"),
        lambertian_normal_error=compared.get("lambertian_normal_error"),
        notes=notes,
        seconds=time.perf_counter() - began,
        capture=capture,
        held_out_capture=hidden,
        state=state,
    )


def _map_errors(capture: ObjectCapture, state: FittedObject) -> dict[str, FloatArray]:
    """Return the maps of standard errors; a colour has the RMS error of its channels."""
    assert state.calibration is not None
    errors = np.sqrt((state.weight_errors**2).mean(axis=1)).astype(np.float32)
    maps = {
        name: capture.to_picture(errors[:, k])
        for k, name in enumerate(state.calibration.parameters.lobes)
    }
    return maps | {"normal": capture.to_picture(state.normal_errors.astype(np.float32))}


def _compare(
    capture: ObjectCapture, hidden: ObjectCapture | None, state: FittedObject
) -> dict[str, Any]:
    """Return the attributes of `ObjectMaps` that compare it with photographs and true normals."""
    known = state.calibration
    assert known is not None
    fitted = predict_photographs(
        capture.with_exposures(known.exposures), known.reflection, state.normals, state.weights
    )
    compared: dict[str, Any] = {"fitted_errors": Comparison.collect(fitted)}
    if hidden is None and capture.normals is None:
        return compared
    normals, albedos = _fit_lambertian(capture, known.brightness)
    if hidden is not None:
        errors = predict_photographs(hidden, known.reflection, state.normals, state.weights)
        compared["held_out_errors"] = Comparison.collect(errors)
        matt = Reflection(labels.model("lambert"), {}, known.dark_offset)
        errors = predict_photographs(hidden, matt, normals, albedos[:, :, None])
        compared["lambertian_errors"] = Comparison.collect(errors)
    if capture.normals is not None and np.isfinite(capture.normals).all(axis=1).any():
        compared["normal_error"] = _average_angle(state.normals, capture.normals)
        compared["lambertian_normal_error"] = _average_angle(normals, capture.normals)
    return compared


def _fit_lambertian(capture: ObjectCapture, brightness: float) -> tuple[FloatArray, FloatArray]:
    """Return normals and albedos (n, 3) of all pixels by Lambertian photometric stereo."""
    normals, albedos = [], []
    for rows in split_into_tiles(capture.values.shape[1], len(capture.lights)):
        tile = Tile.collect(capture, rows, np.ones(len(capture.lights)))
        own_normals, own_albedos = estimate_normals(tile, brightness, robust=False)
        normals.append(own_normals)
        albedos.append(own_albedos)
    return np.concatenate(normals), np.concatenate(albedos)


def _average_angle(a: FloatArray, b: FloatArray) -> float:
    """Return the mean angle [degrees] between unit vectors (n, 3), where both are known."""
    return float(np.nanmean(compute_angles(a, b)))
