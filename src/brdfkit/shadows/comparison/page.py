"""The page of a `ShadowComparison`: its table, and the pictures of each view in each light."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from brdfkit.core.array_types import AnyArray, FloatArray
from brdfkit.core.colours import to_srgb
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.files import require_writable
from brdfkit.core.pages import page
from brdfkit.core.pages.images import apply_colour_map, draw_colour_bar, encode_webp, shrink_picture
from brdfkit.core.version import __version__
from brdfkit.images.errors.flip import flip
from brdfkit.shadows.comparison.map_pictures import CHECKS, OUTSIDE, MapPictures
from brdfkit.shadows.comparison.pictures import Pictures
from brdfkit.shadows.comparison.scores import Scores, format_scores

FLIP = ">FLIP"  # heading of the column of FLIP errors; ">" aligns the column to the right
MAX_WIDTH = 320  # largest width of a picture on the page [pixels]
QUALITY = 60  # quality of the WebP pictures, from 0 to 100
ERROR_SCALE = "RdBu_r"  # matplotlib's colour map for errors: blue for lost light, red for gained
ERROR_STEPS = 8  # number of colours from no error to the largest; few colours make small files
TINTS = "Set2"  # matplotlib's palette with a colour for each shadow map
NO_SURFACE = (0.16, 0.2, 0.3)  # colour, in linear sRGB, of texels whose light ray meets no surface


def require_page_path(path: str | Path) -> None:
    """Raise `BrdfkitError` unless `path` ends in .html or .htm and can be written."""
    if Path(path).suffix.lower() not in (".html", ".htm"):
        raise BrdfkitError(f"{path}: a comparison is written as an HTML page; end it in .html.")
    require_writable(path)


def write_page(
    comparison: Any, path: str | Path, progress: Callable[[int, int], object] | None = None
) -> None:
    """Write the page of a `ShadowComparison`; `progress` is called with (done, total).

    After Ctrl-C the page has the table alone, as drawing the pictures takes as long as scoring
    them.
    """
    require_page_path(path)
    order = list(comparison.means)
    pictures = () if comparison.interrupted else comparison.pictures
    report = progress or (lambda done, total: None)
    flips = np.full((len(pictures), len(order)), np.nan)
    places = []
    for index, place in enumerate(pictures):
        report(index, len(pictures))
        flips[index] = compute_flips(place, order)
        scores = [comparison.scores[label][index] for label in order]
        places.append(describe_view(place, order, scores, flips[index]))
    columns, rows = comparison.columns, comparison.table()
    has_flip = bool(np.isfinite(flips).any())
    if has_flip:
        columns, rows = (*columns, FLIP), add_flip_column(rows, flips)
    page.write_page(
        "shadows.html",
        path,
        best=comparison.best,
        meaning=comparison.meaning,
        columns=columns,
        rows=rows,
        flip=has_flip,
        relative_columns=comparison.columns,
        relative=format_scores(comparison.relative),
        bar=draw_colour_bar(ERROR_SCALE),
        places=places,
        checks=CHECKS,
        version=__version__,
    )


def describe_view(
    place: Pictures, order: Sequence[str], scores: Sequence[Scores], flips: FloatArray
) -> dict[str, Any]:
    """Return what the page shows of a view in a light: titles, pictures and captions, by name.

    place : the pictures of the view in this light.
    order : the techniques in their order on the page.
    scores, flips : the scores and the FLIP errors of the techniques, in this order.
    """
    exact = place.radiance(place.exact)
    white = float(np.percentile(exact[exact > 0], 99)) if exact.any() else 1.0
    draw = partial(draw_radiance, white=white)
    techniques = []
    for label, its_scores, its_flip in zip(order, scores, flips, strict=True):
        lit = place.lit(label)
        techniques.append(
            {
                "name": label,
                "said": describe_scores(its_scores, its_flip),
                "picture": draw(place.radiance(lit)),
                "error": draw_errors(np.where(place.facing, lit - place.exact, 0)),
            }
        )
    maps = [
        {"name": label, "texels": draw_texels(maps), "depths": draw_depths(maps.depths)}
        for label, maps in place.maps.items()
    ]
    return {
        "title": place.title,
        "exact": draw(exact),
        "unshadowed": draw(place.unshadowed),
        "techniques": techniques,
        "maps": maps,
    }


def describe_scores(scores: Scores, its_flip: float) -> str:
    """Return the caption of a technique's picture: its main scores, and its FLIP error if known."""
    if np.isnan(scores.wrong):
        return "nothing is in the light"
    text = f"PSNR {scores.psnr:.1f} dB, wrong {100 * scores.wrong:.2f} %"
    return text if np.isnan(its_flip) else f"{text}, FLIP {its_flip:.4f}"


def compute_flips(place: Pictures, order: Sequence[str]) -> list[float]:
    """Return the FLIP error of each technique in a view, from pictures of the size on the page.

    It is NaN without the package flip-evaluator, and if no surface faces the light.
    """
    exact, mask = (
        shrink_for_page(place.radiance(place.exact)),
        shrink_for_page(place.facing[..., None])[..., 0] > 0,
    )
    if not mask.any():
        return [np.nan] * len(order)
    try:
        return [
            flip(exact, shrink_for_page(place.radiance(place.lit(label))), mask) for label in order
        ]
    except ImportError:
        return [np.nan] * len(order)


def add_flip_column(rows: Sequence[tuple[str, ...]], flips: FloatArray) -> list[tuple[str, ...]]:
    """Return the rows of the table, each with its mean FLIP error over the views as a new cell.

    flips : FLIP errors (views, rows); a view with an unknown error, NaN, does not count.
    """
    known = flips[np.isfinite(flips).all(axis=1)]
    return [(*row, f"{mean:.4f}") for row, mean in zip(rows, known.mean(axis=0), strict=True)]


def shrink_for_page(picture: AnyArray) -> FloatArray:
    """Return a picture (height, width, n), halved until it is at most `MAX_WIDTH` wide."""
    return shrink_picture(np.asarray(picture, float), MAX_WIDTH)


def draw_radiance(picture: FloatArray, white: float) -> Any:
    """Draw a picture (height, width, 3) in which `white` is the brightest value, as a data URL."""
    return encode_as_data_url(shrink_for_page(picture / white))


def draw_errors(errors: FloatArray) -> Any:
    """Draw errors (height, width), light gained (positive) or lost (negative), as a data URL."""
    shares = np.round(shrink_for_page(errors[..., None])[..., 0] * ERROR_STEPS) / ERROR_STEPS
    return encode_webp(apply_colour_map(ERROR_SCALE, (shares + 1) / 2)[..., :3], lossless=True)


def draw_texels(maps: MapPictures) -> Any:
    """Draw the scene under the checkerboard of its shadow maps, a colour per map, as a data URL."""
    tints = np.ones((OUTSIDE + 1, 3))
    tints[:OUTSIDE] = apply_colour_map(TINTS, np.arange(OUTSIDE) % 8 / 7.99)[:, :3] ** 2
    return encode_as_data_url(shrink_for_page(maps.shade[..., None] * tints[maps.part]))


def draw_depths(depths: FloatArray) -> Any:
    """Draw depths (side, side) from 0, near and bright, to 1, far and dark, as a data URL."""
    bright = (1 - 0.9 * depths.astype(float))[..., None] ** 2
    return encode_as_data_url(np.where(np.isnan(bright), NO_SURFACE, bright))


def encode_as_data_url(linear: FloatArray) -> Any:
    """Compress a picture (height, width, 3) of linear sRGB, with loss, to a data URL."""
    return encode_webp(to_srgb(linear), quality=QUALITY)
