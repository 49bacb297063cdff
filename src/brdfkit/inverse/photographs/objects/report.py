"""Writes the HTML report of an `ObjectMaps`: photographs beside predictions, maps, and errors."""

from pathlib import Path
from typing import Any

import numpy as np

from brdfkit.core.array_types import AnyArray, FloatArray
from brdfkit.core.documents import Paragraph, Table
from brdfkit.core.documents.parts import SOFT
from brdfkit.core.pages import page
from brdfkit.core.pages.images import apply_colour_map, encode_jpeg, encode_png, shrink_picture
from brdfkit.core.version import __version__
from brdfkit.inverse.photographs.capture.object_capture import ObjectCapture
from brdfkit.inverse.photographs.result.comparison import compute_angles

WIDEST = 640  # largest side of a picture on the page [pixels]
MARGIN = 4  # pixels around the object that are shown
VALUE_SCALE, DIFFERENCE_SCALE = "viridis", "RdBu_r"
LARGEST_DIFFERENCE = 0.3  # relative difference from a photograph at the ends of the colour scale
PHOTOGRAPHS = 12  # largest number of photographs on the page
# Share of the brightest map that white shows at least, so that maps of about 0 look black
DARKEST_WHITE = 0.02
GREY = 0.5  # what is outside of the object in maps of errors
LARGEST_ANGLE = 10.0  # error of a normal at the end of the colour scale [degrees]
SHADOW_SHARE = 0.02  # share of the white level below which a photograph has no relative difference


def write_report(maps: Any, path: Path) -> None:
    """Write the HTML report of an `ObjectMaps` to a file."""
    document = maps.document()
    paragraphs = [part for part in document.parts if isinstance(part, Paragraph)]
    tables = [part for part in document.parts if isinstance(part, Table)]
    page.write_page(
        "object.html",
        path,
        title=document.title,
        tables=[(part.columns, part.rows) for part in reversed(tables)],
        notes=[part.text for part in paragraphs if part.kind != SOFT],
        explanations=[part.text for part in paragraphs if part.kind == SOFT],
        maps=[_describe_map(maps, name) for name in maps.maps],
        checks=_describe_checks(maps),
        photographs=_describe_photographs(maps),
        are_held_out=maps.held_out_errors is not None,
        largest_difference=round(100 * LARGEST_DIFFERENCE),
        version=__version__,
    )


def _crop(maps: Any, picture: AnyArray) -> AnyArray:
    """Return the part of a picture (height, width, c) around the object, shrunk for the page."""
    rows, columns = np.nonzero(maps.mask)
    top, left = max(0, rows.min() - MARGIN), max(0, columns.min() - MARGIN)
    part = picture[top : rows.max() + MARGIN + 1, left : columns.max() + MARGIN + 1]
    return shrink_picture(part, WIDEST)


def _colour(maps: Any, values: FloatArray, low: float, high: float, scale: str) -> str:
    """Return values (height, width) of the object as a PNG, coloured from `low` to `high`."""
    shares = (values - low) / max(high - low, 1e-12)
    colours = apply_colour_map(scale, shares)[..., :3]
    return encode_png(_crop(maps, np.where(maps.mask[..., None], colours, GREY)))


def _describe_map(maps: Any, name: str) -> dict[str, str | None]:
    """Return the template's entries for a map: its picture, its scale and its standard errors."""
    values, errors = maps.maps[name], maps.uncertainty.get(name)
    own = values[maps.mask]
    if name == "normal":
        shown = np.where(maps.mask[..., None], (values + 1) / 2, GREY)
        picture, scale = encode_png(_crop(maps, shown)), "x, y and z as red, green and blue"
    else:
        brightest = max(float(np.quantile(part, 0.99)) for part in _list_weights(maps))
        white = max(1e-9, DARKEST_WHITE * brightest, float(np.quantile(own, 0.99)))
        picture, scale = encode_jpeg(_crop(maps, values / white)), f"white is {white:.3g}"
    entry = {"name": name, "picture": picture, "scale": scale, "error": None, "error_scale": None}
    if errors is not None:
        unit, errors = ("°", np.degrees(errors)) if name == "normal" else ("", errors)
        high = float(np.quantile(errors[maps.mask], 0.9))
        entry["error"] = _colour(maps, errors, 0, high, VALUE_SCALE)
        entry["error_scale"] = f"standard error, 0 (dark) to {high:.2g}{unit} (bright)"
    return entry


def _list_weights(maps: Any) -> list[FloatArray]:
    """Return the weights of all lobes, of the object's pixels alone."""
    return [values[maps.mask] for name, values in maps.maps.items() if name != "normal"]


def _describe_checks(maps: Any) -> list[dict[str, str]]:
    """Return the template's entries for the number of photographs, and the errors of normals."""
    count = len(maps.capture.names)
    checks = [
        {
            "name": "photographs that count",
            "picture": _colour(maps, maps.lights, 0, count, VALUE_SCALE),
            "scale": f"0 (dark) to {count} (bright); in the others the pixel is in the shadow or "
            "clipped",
        }
    ]
    truth = maps.capture.normals
    if truth is not None and maps.normal_error is not None:
        own = maps.maps["normal"][maps.mask]
        angle = compute_angles(own, truth)
        known = np.isfinite(angle)
        picture = maps.capture.to_picture(np.where(known, angle, 0))
        checks.append(
            {
                "name": "errors of the normals",
                "picture": _colour(maps, picture, 0, LARGEST_ANGLE, VALUE_SCALE),
                "scale": f"angle to the true normal, 0° (dark) to {LARGEST_ANGLE:g}° (bright); "
                f"{angle[known].mean():.2f}° in the mean",
            }
        )
    return checks


def _describe_photographs(maps: Any) -> list[dict[str, str]]:
    """Return the template's entries for photographs that were held out, or else fitted ones."""
    if maps.held_out_errors is not None:
        capture, comparison = maps.held_out_capture, maps.held_out_errors
    else:
        exposures = np.array([maps.exposures[name] for name in maps.capture.names])
        capture, comparison = maps.capture.with_exposures(exposures), maps.fitted_errors
    if comparison is None:
        return []
    medians = {name: median for name, (median, _) in comparison.by_name.items()}
    names = sorted(medians, key=medians.__getitem__, reverse=True)
    chosen = names[:: max(1, -(-len(names) // PHOTOGRAPHS))]
    return [_describe_photograph(maps, capture, name, comparison.by_name[name]) for name in chosen]


def _describe_photograph(
    maps: Any, capture: ObjectCapture, name: str, errors: tuple[float, float]
) -> dict[str, str]:
    """Return the template's entries for a photograph: itself, its prediction, their difference."""
    number = capture.names.index(name)
    photograph = capture.to_picture(capture.values[number].astype(float))
    predicted = maps.predict(capture.lights.select(np.array([number])))[0]
    white = max(1e-12, float(np.quantile(photograph[maps.mask], 0.99)))
    brightness = photograph.mean(axis=2)
    difference = (predicted.mean(axis=2) - brightness) / np.maximum(brightness, 1e-12)
    difference[brightness < SHADOW_SHARE * white] = 0
    limits = -LARGEST_DIFFERENCE, LARGEST_DIFFERENCE
    return {
        "name": name,
        "errors": f"errors: median {100 * errors[0]:.2g} %, 90th percentile "
        f"{100 * errors[1]:.2g} %",
        "photograph": encode_jpeg(_crop(maps, photograph / white)),
        "prediction": encode_jpeg(_crop(maps, predicted / white)),
        "difference": _colour(maps, difference, *limits, DIFFERENCE_SCALE),
    }
