"""Writes the HTML report of an `Svbrdf`: maps, errors, and photographs beside renderings."""

from pathlib import Path
from typing import Any

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.core.pages import page
from brdfkit.core.pages.images import apply_colour_map, encode_jpeg, encode_png, shrink_picture
from brdfkit.core.version import __version__
from brdfkit.inverse.photographs.capture.observations import sample_at_texels
from brdfkit.inverse.photographs.maps.residuals import UNEXPLAINED

WIDEST = 512  # largest width of a picture on the page [pixels]
VALUE_SCALE, DIFFERENCE_SCALE = "viridis", "RdBu_r"
# Residual of a texel at the end of the colour scale, as a multiple of the noise
LARGEST_MISFIT = 2 * UNEXPLAINED
LARGEST_DIFFERENCE = 0.2  # relative difference from a photograph at the ends of the colour scale
# Share of the white level that is added to radiances before differences are divided by them, so
# that relative differences of dark pixels stay finite
DARK_OFFSET = 0.05


def write_report(svbrdf: Any, path: Path) -> None:
    """Write the HTML report of an `Svbrdf` to a file."""
    document = svbrdf.document()
    table, *paragraphs = document.parts
    misfit = svbrdf.misfit
    page.write_page(
        "svbrdf.html",
        path,
        title=document.title,
        columns=table.columns,
        rows=table.rows,
        notes=[paragraph.text for paragraph in paragraphs],
        maps=[_describe_map(svbrdf, name) for name in svbrdf.maps],
        misfit=None if misfit is None else _to_colour_png(misfit, 0, LARGEST_MISFIT),
        largest_misfit=LARGEST_MISFIT,
        photographs=[] if misfit is None else _describe_photographs(svbrdf),
        version=__version__,
    )


def _describe_map(svbrdf: Any, name: str) -> dict[str, str | None]:
    """Return the template's entries for a map: its picture, its range and its standard errors."""
    values, errors = svbrdf.maps[name], svbrdf.uncertainty.get(name)
    if name == "normal":
        picture, scale = (
            encode_png(shrink_picture((values + 1) / 2, WIDEST)),
            "x, y and z as red, green and blue",
        )
    elif values.ndim == 3:
        white = max(1e-6, float(np.quantile(values, 0.99)))
        picture = encode_jpeg(shrink_picture(values / white, WIDEST))
        scale = f"white is {white:.3g}"
    else:
        low, high = np.quantile(values, (0.01, 0.99))
        picture, scale = (
            _to_colour_png(values, low, high),
            f"{low:.3g} (dark) to {high:.3g} (bright)",
        )
    shown = {"name": name, "picture": picture, "scale": scale, "error": None, "error_scale": None}
    if errors is not None:
        unit, errors = ("°", np.degrees(errors)) if name == "normal" else ("", errors)
        # the scale ends here, as a few errors at the edge are far larger
        high = float(np.quantile(errors, 0.9))
        shown["error"] = _to_colour_png(errors, 0, high)
        shown["error_scale"] = f"standard error, 0 (dark) to {high:.2g}{unit} (bright)"
    return shown


def _describe_photographs(svbrdf: Any) -> list[dict[str, str]]:
    """Return the template's entries for each photograph and its rendering, the worst one first."""
    capture = svbrdf.capture
    photographs, predictions = (
        sample_at_texels(capture, pictures, svbrdf.shape).reshape(-1, *svbrdf.shape, 3)
        for pictures in (capture.pictures, svbrdf.rendered)
    )
    shown = []
    for k in np.argsort([svbrdf.predicted[name] for name in capture.names]):
        photograph, prediction = photographs[k], predictions[k]
        white = max(1e-12, float(np.quantile(photograph, 0.99)))
        difference = (prediction - photograph).mean(axis=2)
        difference /= photograph.mean(axis=2) + DARK_OFFSET * white
        scale = -LARGEST_DIFFERENCE, LARGEST_DIFFERENCE, DIFFERENCE_SCALE
        shown.append(
            {
                "name": capture.names[k],
                "psnr": f"PSNR {svbrdf.predicted[capture.names[k]]:.1f} dB",
                "photograph": encode_jpeg(shrink_picture(photograph / white, WIDEST)),
                "prediction": encode_jpeg(shrink_picture(prediction / white, WIDEST)),
                "difference": _to_colour_png(difference, *scale),
            }
        )
    return shown


def _to_colour_png(values: FloatArray, low: float, high: float, scale: str = VALUE_SCALE) -> str:
    """Return values (height, width) as a PNG in a data URL, coloured from `low` to `high`.

    `scale` is the name of a colour map of matplotlib.
    """
    shares = (shrink_picture(values[..., None], WIDEST)[..., 0] - low) / max(high - low, 1e-12)
    return encode_png(apply_colour_map(scale, shares)[..., :3])
