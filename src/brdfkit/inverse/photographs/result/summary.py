"""Summarises an `Svbrdf` as a document, which prints as text and as HTML."""

from collections.abc import Collection
from typing import Any

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.core.documents import Document, Paragraph, Table
from brdfkit.core.documents.parts import SOFT
from brdfkit.inverse.photographs.result.comparison import Comparison


def describe_svbrdf(svbrdf: Any) -> Document:
    """Return an `Svbrdf` as a document: a row for each map, notes, and errors of renderings."""
    rows = tuple(
        (
            name,
            *_format_quantiles(name, values),
            _format_error(name, svbrdf.uncertainty.get(name)),
        )
        for name, values in svbrdf.maps.items()
    )
    height, width = svbrdf.shape
    tried = ", ".join(f"{tau:g}: {100 * e:.2g} %" for tau, e in svbrdf.held_out.items())
    chosen = f", by lights held out ({tried})" if tried else ""
    count = len(svbrdf.capture.names)
    return Document(
        f"{svbrdf.name}: {svbrdf.model}, {width} × {height} texels from {count} photographs",
        (
            Table(rows, ("map", ">5 %", ">median", ">95 %", ">± median")),
            *(
                Paragraph(note)
                for note in (*describe_fixed_parameters(svbrdf.fixed), *svbrdf.notes)
            ),
            *_describe_rendering_difference(svbrdf.residual, svbrdf.predicted.values()),
            *_describe_held_out_errors(svbrdf.held_out_errors),
            Paragraph(
                f"smoothness {svbrdf.smoothness:g}{chosen}; {svbrdf.seconds:.1f} s", kind=SOFT
            ),
        ),
    )


def describe_fixed_parameters(values: dict[str, float]) -> tuple[str, ...]:
    """Return a sentence on the parameters with one value everywhere, if there are any."""
    if not values:
        return ()
    equal = ", ".join(f"{name} = {value:.3g}" for name, value in values.items())
    at_normal = "; at normal incidence the specular reflectance counts times f0"
    return (f"Everywhere {equal}{at_normal if 'f0' in values else ''}.",)


def _describe_rendering_difference(
    residual: float, psnr: Collection[float]
) -> tuple[Paragraph, ...]:
    """Return a sentence on the difference of Mitsuba's renderings from the photographs.

    `residual` is the RMS relative difference, and `psnr` holds the PSNR [dB] of each rendering;
    there is no sentence without renderings.
    """
    if not psnr:
        return ()
    text = (
        f"Mitsuba's renderings of the maps differ from the photographs by {100 * residual:.2g} % "
        f"(RMS); PSNR {min(psnr):.1f} to {max(psnr):.1f} dB."
    )
    return (Paragraph(text),)


def _describe_held_out_errors(errors: Comparison | None) -> tuple[Paragraph, ...]:
    """Return a sentence on the errors of photographs that were held out, if there are any."""
    if errors is None:
        return ()
    text = (
        f"The {len(errors.by_name)} photographs that were held out are predicted with errors of "
        f"{100 * errors.median:.2g} % in the median and {100 * errors.high:.2g} % at 90 %."
    )
    return (Paragraph(text),)


def _format_quantiles(name: str, values: FloatArray) -> tuple[str, ...]:
    """Return the quantiles 5 %, 50 % and 95 % of a map as text.

    For normals they are those of the angle to the sample's z axis, in degrees.
    """
    if name == "normal":
        angle = np.degrees(np.arccos(np.clip(values[..., 2], -1, 1)))
        return tuple(f"{q:.2g}°" for q in np.quantile(angle, (0.05, 0.5, 0.95)))
    return tuple(f"{q:.3g}" for q in np.quantile(values, (0.05, 0.5, 0.95)))


def _format_error(name: str, errors: FloatArray | None) -> str:
    """Return the median of a map's standard errors as text, "" if they are unknown.

    The errors of normals are in radians, and their text is in degrees.
    """
    if errors is None:
        return ""
    median = float(np.median(errors))
    return f"{np.degrees(median):.2g}°" if name == "normal" else f"{median:.2g}"
