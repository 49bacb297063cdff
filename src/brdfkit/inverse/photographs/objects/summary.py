"""Summarises an `ObjectMaps` as a document, for terminals and notebooks."""

from typing import Any

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.core.documents import Document, Paragraph, Table
from brdfkit.core.documents.parts import SOFT

ERROR_COLUMNS = "photographs", ">median", ">90 %", ">median, adapted", ">90 %, adapted"


def describe_object(maps: Any) -> Document:
    """Return an `ObjectMaps` as a document: errors of photographs, maps, and notes."""
    height, width = maps.shape
    count, pixels = len(maps.capture.names), int(maps.mask.sum())
    rows = tuple(
        (name, *_format_quantiles(name, values[maps.mask]), _format_error(maps, name))
        for name, values in maps.maps.items()
    )
    equal = ", ".join(f"{name} = {value:.3g}" for name, value in maps.fixed.items())
    return Document(
        f"{maps.name}: {maps.model}, {pixels:,} of {width} × {height} pixels from {count} "
        "photographs",
        (
            Table(rows, ("map", ">5 %", ">median", ">95 %", ">± median")),
            Table(_list_errors(maps), ERROR_COLUMNS),
            *((Paragraph(f"Everywhere {equal}."),) if equal else ()),
            *_describe_normals(maps),
            *(Paragraph(note) for note in maps.notes),
            Paragraph(
                "Errors are relative to the photographs, over all pixels that face the light; "
                "adapted: if each prediction is multiplied by the factor that suits its "
                f"photograph; residual noise {100 * maps.noise:.2g} %; {maps.seconds:.1f} s",
                kind=SOFT,
            ),
        ),
    )


def _list_errors(maps: Any) -> tuple[tuple[str, ...], ...]:
    """Return a row of errors for the photographs that were fitted, and that were held out."""
    hidden = len(maps.held_out_capture.names) if maps.held_out_capture else 0
    parts = (
        (f"{len(maps.capture.names)} fitted", maps.fitted_errors),
        (f"{hidden} held out", maps.held_out_errors),
        ("held out, by Lambertian stereo", maps.lambertian_errors),
    )
    return tuple(
        (
            name,
            *(
                f"{100 * value:.2g} %"
                for value in (part.median, part.high, part.adapted_median, part.adapted_high)
            ),
        )
        for name, part in parts
        if part is not None
    )


def _describe_normals(maps: Any) -> tuple[Paragraph, ...]:
    """Return a sentence on the error of the normals, where the true ones are known."""
    if maps.normal_error is None:
        return ()
    text = (
        f"The normals are {maps.normal_error:.2f}° off in the mean; those of Lambertian "
        f"photometric stereo {maps.lambertian_normal_error:.2f}°."
    )
    return (Paragraph(text),)


def _format_quantiles(name: str, values: FloatArray) -> tuple[str, ...]:
    """Return the quantiles 5 %, 50 % and 95 % of a map's pixels as text.

    For normals they are those of the angle to the camera's axis, in degrees.
    """
    if name == "normal":
        angle = np.degrees(np.arccos(np.clip(values[..., 2], -1, 1)))
        return tuple(f"{q:.2g}°" for q in np.quantile(angle, (0.05, 0.5, 0.95)))
    return tuple(f"{q:.3g}" for q in np.quantile(values, (0.05, 0.5, 0.95)))


def _format_error(maps: Any, name: str) -> str:
    """Return the median of a map's standard errors as text, "" if they are unknown."""
    errors = maps.uncertainty.get(name)
    if errors is None:
        return ""
    median = float(np.median(errors[maps.mask]))
    return f"{np.degrees(median):.2g}°" if name == "normal" else f"{median:.2g}"
