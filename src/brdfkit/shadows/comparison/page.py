"""The page of a `ShadowComparison`: its table, and the pictures of each view in each light."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.files import require_writable
from brdfkit.core.pages import page
from brdfkit.core.pages.images import draw_colour_bar
from brdfkit.core.version import __version__
from brdfkit.images.errors.flip import flip
from brdfkit.shadows.comparison.map_pictures import CHECKS
from brdfkit.shadows.comparison.page_pictures import (
    ERROR_SCALE,
    draw_depths,
    draw_errors,
    draw_radiance,
    draw_texels,
    shrink_for_page,
)
from brdfkit.shadows.comparison.pictures import Pictures
from brdfkit.shadows.comparison.scores import Scores, to_texts

FLIP = ">FLIP"


def require_page(path: str | Path) -> None:
    """Raise `BrdfkitError` unless a page can be written there."""
    if Path(path).suffix.lower() not in (".html", ".htm"):
        raise BrdfkitError(f"{path}: a comparison is written as a page; name it .html.")
    require_writable(path)


def write_page(
    comparison: Any, path: str | Path, progress: Callable[[int, int], object] | None = None
) -> None:
    """Write the page of a `ShadowComparison`; `progress` is called with (done, total).

    After Ctrl-C it has the table alone, as drawing the pictures takes as long as scoring them.
    """
    require_page(path)
    order = list(comparison.means)
    pictures = () if comparison.interrupted else comparison.pictures
    report = progress or (lambda done, total: None)
    flips = np.full((len(pictures), len(order)), np.nan)
    places = []
    for index, place in enumerate(pictures):
        report(index, len(pictures))
        flips[index] = compute_flips(place, order)
        scores = [comparison.scores[label][index] for label in order]
        places.append(describe_place(place, order, scores, flips[index]))
    columns, rows = comparison.columns, comparison.table()
    has_flip = bool(np.isfinite(flips).any())
    if has_flip:
        columns, rows = (*columns, FLIP), add_flips(rows, flips)
    page.write_page(
        "shadows.html",
        path,
        best=comparison.best,
        meaning=comparison.meaning,
        columns=columns,
        rows=rows,
        flip=has_flip,
        relative_columns=comparison.columns,
        relative=to_texts(comparison.relative),
        bar=draw_colour_bar(ERROR_SCALE),
        places=places,
        checks=CHECKS,
        version=__version__,
    )


def describe_place(
    place: Pictures, order: Sequence[str], scores: Sequence[Scores], flips: FloatArray
) -> dict[str, Any]:
    """Return the template's values for a view in a light, with the techniques in this `order`."""
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
    """Return the scores of a picture as a caption."""
    if np.isnan(scores.wrong):
        return "nothing is in the light"
    text = f"PSNR {scores.psnr:.1f} dB, wrong {100 * scores.wrong:.2f} %"
    return text if np.isnan(its_flip) else f"{text}, FLIP {its_flip:.4f}"


def compute_flips(place: Pictures, order: Sequence[str]) -> list[float]:
    """Return the FLIP error of each technique's small picture.

    It is NaN without the package flip-evaluator, and where nothing faces the light.
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


def add_flips(rows: Sequence[tuple[str, ...]], flips: FloatArray) -> list[tuple[str, ...]]:
    """Return the rows of a table, each with the mean FLIP of all places where it is known."""
    known = flips[np.isfinite(flips).all(axis=1)]
    return [(*row, f"{mean:.4f}") for row, mean in zip(rows, known.mean(axis=0), strict=True)]
