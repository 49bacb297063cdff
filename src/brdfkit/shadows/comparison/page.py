"""The page of a `ShadowComparison`: its table, and the pictures of each view in each light."""

from functools import partial
from pathlib import Path

import numpy as np

from brdfkit.core.errors import BrdfkitError
from brdfkit.core.files import require_writable
from brdfkit.core.pages import page
from brdfkit.core.pages.images import draw_colour_bar
from brdfkit.core.version import __version__
from brdfkit.images.errors.flip import flip
from brdfkit.shadows.comparison.map_pictures import CHECKS
from brdfkit.shadows.comparison.page_pictures import (
    ERRORS,
    draw_depths,
    draw_errors,
    draw_radiance,
    draw_texels,
    small,
)
from brdfkit.shadows.comparison.scores import to_texts

FLIP = ">FLIP"


def require_page(path):
    """Raise `BrdfkitError` unless a page can be written there."""
    if Path(path).suffix.lower() not in (".html", ".htm"):
        raise BrdfkitError(f"{path}: a comparison is written as a page; name it .html.")
    require_writable(path)


def write_page(comparison, path, progress=None):
    """Write the page of a `ShadowComparison`; `progress`: called with (done, total).

    After Ctrl-C it is the table alone: to draw the pictures takes as long as to score them.
    """
    require_page(path)
    order = list(comparison.means)
    pictures = () if comparison.interrupted else comparison.pictures
    report = progress or (lambda done, total: None)
    flips = np.full((len(pictures), len(order)), np.nan)
    places = []
    for number, place in enumerate(pictures):
        report(number, len(pictures))
        flips[number] = flips_of(place, order)
        places.append(contents(place, order, comparison, number, flips[number]))
    columns, rows = comparison.columns, comparison.table()
    has_flip = bool(np.isfinite(flips).any())
    if has_flip:
        columns, rows = (*columns, FLIP), with_flip(rows, flips)
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
        bar=draw_colour_bar(ERRORS),
        places=places,
        checks=CHECKS,
        version=__version__,
    )


def contents(place, order, comparison, number, flips):
    """What the page shows of a `Pictures`, the techniques in their `order`."""
    exact = place.radiance(place.exact)
    white = np.percentile(exact[exact > 0], 99) if exact.any() else 1.0
    draw = partial(draw_radiance, white=white)
    techniques = []
    for label, its_flip in zip(order, flips, strict=True):
        lit, scores = place.lit(label), comparison.scores[label][number]
        techniques.append(
            {
                "name": label,
                "said": said(scores, its_flip),
                "picture": draw(place.radiance(lit)),
                "error": draw_errors(np.where(place.facing, lit - place.exact, 0)),
            }
        )
    maps = [
        {"name": label, "texels": draw_texels(one), "depths": draw_depths(one.depths)}
        for label, one in place.maps.items()
    ]
    return {
        "title": place.title,
        "exact": draw(exact),
        "unshadowed": draw(place.unshadowed),
        "techniques": techniques,
        "maps": maps,
    }


def said(scores, its_flip):
    """The scores of a picture in words."""
    if np.isnan(scores.wrong):
        return "nothing is in the light"
    text = f"PSNR {scores.psnr:.1f} dB, wrong {100 * scores.wrong:.2f} %"
    return text if np.isnan(its_flip) else f"{text}, FLIP {its_flip:.4f}"


def flips_of(place, order):
    """FLIP of the small pictures by each technique; nan without the package flip-evaluator, and
    where nothing faces the light."""
    exact, mask = small(place.radiance(place.exact)), small(place.facing[..., None])[..., 0] > 0
    if not mask.any():
        return [np.nan] * len(order)
    try:
        return [flip(exact, small(place.radiance(place.lit(label))), mask) for label in order]
    except ImportError:
        return [np.nan] * len(order)


def with_flip(rows, flips):
    """The rows of a table, and in each the mean FLIP of all places where it is known."""
    known = flips[np.isfinite(flips).all(axis=1)]
    return [(*row, f"{mean:.4f}") for row, mean in zip(rows, known.mean(axis=0), strict=True)]
