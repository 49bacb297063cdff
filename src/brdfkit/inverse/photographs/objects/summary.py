"""Summarises an `ObjectMaps` as a document, for terminals and notebooks."""

from typing import Any

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.core.documents import Document, Paragraph, Table
from brdfkit.core.documents.parts import SOFT
from brdfkit.inverse.photographs.result.summary import describe_fixed_parameters

SMALLEST = 1e-5  # share of the largest weight below which a weight is shown as 0
ERROR_COLUMNS = "photographs", ">median", ">90 %", ">median, adapted", ">90 %, adapted"


def describe_object(maps: Any) -> Document:
    """Return an `ObjectMaps` as a document: errors of photographs, maps, and notes."""
    height, width = maps.shape
    count, pixels = len(maps.capture.names), int(maps.mask.sum())
    # Weights far below the largest one are rounding errors of 0
    least = SMALLEST * max(
        float(values.max()) for name, values in maps.maps.items() if name != "normal"
    )
    rows = tuple(
        (name, *_format_quantiles(name, values[maps.mask], least), _format_error(maps, name))
        for name, values in maps.maps.items()
    )
    return Document(
        f"{maps.name}: {maps.model}, {pixels:,} of {width} × {height} pixels from {count} "
        "photographs",
        (
            Table(rows, ("map", ">5 %", ">median", ">95 %", ">± median")),
            *((Table(errors, ERROR_COLUMNS),) if (errors := _list_errors(maps)) else ()),
            *(Paragraph(note) for note in describe_fixed_parameters(maps.fixed)),
            *_describe_normals(maps),
            *(Paragraph(_begin_sentence(note)) for note in maps.notes),
            *_explain_numbers(maps),
        ),
    )


def _explain_numbers(maps: Any) -> tuple[Paragraph, ...]:
    """Return sentences on what the numbers of the tables are."""
    errors: tuple[str, ...] = ()
    if maps.fitted_errors is not None:
        errors = (
            "The errors of photographs are relative ones, over all pixels that face the light: the "
            "median and the 90th percentile. Adapted are those if each prediction is multiplied by "
            "the factor that suits its photograph.",
        )
    angles = "The row of the normal has angles to the direction of the camera."
    if maps.uncertainty:
        angles += (
            " ± is the standard error by the noise of the photographs alone: errors by wrong "
            "lights, or by a model that does not suit, come on top."
        )
    time = f"Residual noise {100 * maps.noise:.2g} %; {maps.seconds:.1f} s"
    return tuple(Paragraph(text, kind=SOFT) for text in (angles, *errors, time))


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


def _format_quantiles(name: str, values: FloatArray, least: float) -> tuple[str, ...]:
    """Return the quantiles 5 %, 50 % and 95 % of a map's pixels as text, 0 for those below `least`.

    For normals they are those of the angle to the camera's axis, in degrees.
    """
    if name == "normal":
        angle = np.degrees(np.arccos(np.clip(values[..., 2], -1, 1)))
        return tuple(f"{q:.2g}°" for q in np.quantile(angle, (0.05, 0.5, 0.95)))
    quantiles = np.quantile(values, (0.05, 0.5, 0.95))
    return tuple(f"{q:.3g}" if q >= least else "0" for q in quantiles)


def _format_error(maps: Any, name: str) -> str:
    """Return the median of a map's standard errors as text, "" if they are unknown."""
    errors = maps.uncertainty.get(name)
    if errors is None:
        return ""
    median = float(np.median(errors[maps.mask]))
    return f"{np.degrees(median):.2g}°" if name == "normal" else f"{median:.2g}"


def _begin_sentence(note: str) -> str:
    """Return a note with a capital letter, unless it begins with the name of a file."""
    first = note.split(" ", 1)[0]
    return note[:1].upper() + note[1:] if first.isalpha() else note
