"""Makes resolution-matched shadow maps (DASM), section 2.2.3.2, and counts pages and texels.

A quadtree over the light's map is divided until its texels are as fine as pixels wherever something
is seen. Each leaf that holds something seen has a page, a small map of fixed size. All pages are in
one texture, the atlas, and a second one, the page table, tells which page a place of the light's
map has.
"""

import numpy as np
from brdfkit.theses.ergun2008.views import SIZE, View

from brdfkit.core.jit.llvm import use_variant
from brdfkit.core.jit.threads import in_turn
from brdfkit.shadows.maps.cells import GUTTER, Cell, make_cell_finder
from brdfkit.shadows.maps.partition import Part, Partition
from brdfkit.shadows.maps.partitions import adaptive
from brdfkit.shadows.maps.projection import Projection
from brdfkit.shadows.maps.resolution import texel_area_in_pixels
from brdfkit.theses.claims import NOT_RUN, Claim
from brdfkit.theses.grid import judge_over_grid
from brdfkit.theses.page import Section, Table
from brdfkit.theses.replacing import replace_part

SECONDS = 30
SCENES = "objects_on_a_ground", "street", "compact", "compact_from_afar"
VIEW, LIGHT = "V1", 1
PAGES = 64, 128  # texels along a side of a page
FINEST = 7  # level of the smallest pages: how often the light's map is halved
SETTINGS = "scene", "page"
TEXT = f"""A quadtree over the focused map is divided until a texel is at most a pixel wherever the
picture of {SIZE} × {SIZE} pixels shows something, or {FINEST} times. Each leaf that is seen has a
page of {" or ".join(f"{n}²" for n in PAGES)} texels, with {GUTTER} more on each side, in an atlas;
the page table has an entry of 4 bytes for each place of a grid as fine as the smallest page. Depth
maps, view {VIEW}, light {LIGHT}; *one map* has as many texels as the atlas. `foliage`, which needs
over 1,000 pages of 64² texels, is left out for their time. The thesis has no figures."""


@in_turn
def check_claims(sources, report):
    """Check the claims on resolution-matched shadow maps, and return their section."""
    use_variant()
    found = {}
    for done, name in enumerate(SCENES):
        view = View.load(name, VIEW, LIGHT)
        for page in PAGES:
            found[name, f"{page}²"] = measure_pages(view, page)
        report(done + 1, len(SCENES))
    rows = [
        (
            *cell,
            f"{its['pages']:,}",
            f"{its['texels']:,}",
            f"{its['places']:,}",
            f"{its['pixels']:,}",
            f"{its['matched']:.1f}",
            f"{its['one map']:.1f}",
        )
        for cell, its in found.items()
    ]
    head = (
        *SETTINGS,
        "pages",
        "texels of the atlas",
        "entries of the page table",
        "pixels that are analysed",
        "PSNR [dB]",
        "of one map [dB]",
    )
    claims = [claim_better(found), claim_analysis(found)]
    return Section("Resolution-matched maps", TEXT, claims, [Table(head, rows)])


def measure_pages(view, page):
    """Return counts of pages, texels, places of the page table and pixels, and PSNRs [dB]."""
    made = []

    def make_partition(setup, **settings):
        made.append(make_pages(setup, view, page))
        return made[-1][0]

    with replace_part(adaptive, "make_partition", make_partition):
        matched = view.make_shadow(partition="adaptive")
    partition, table = made[0]
    texels = len(partition.parts) * (page + 2 * GUTTER) ** 2
    one = view.make_shadow(resolution=round(texels**0.5))
    return {
        "pages": len(partition.parts),
        "texels": texels,
        "places": table.size,
        "pixels": int(np.array(view.seen.si.is_valid()).sum()),
        "matched": view.compute_psnr(view.compute_lit(matched)),
        "one map": view.compute_psnr(view.compute_lit(one)),
    }


def make_pages(setup, view, page):
    """Return the `Partition` of a view's pages, and the page table (n, n) of their indices.

    The index is beyond the end where nothing is seen.
    """
    whole = setup.project(setup.placement)
    places, levels = find_levels(whole, view, page)
    leaves = grow_leaves(places, levels)
    seen = [bool(select_leaf(places, leaf).any()) for leaf in leaves]
    indices = np.where(seen, np.cumsum(seen) - 1, sum(seen))
    table = indices[adaptive.make_leaf_table(leaves)]
    resolution = page + 2 * GUTTER
    parts = [
        Part(Cell.from_grid(whole, column, row, 2**level, resolution), resolution)
        for (level, row, column), its in zip(leaves, seen, strict=True)
        if its
    ]
    return Partition(parts, make_cell_finder(whole, table)), table


def find_levels(whole, view, page):
    """Return the places (n, 2) of visible points on the light's map, and the levels they need."""
    seen, opaque = view.seen, whole.make_opaque()
    camera = Projection.from_matrix(view.placement.camera.matrix, view.placement.light)
    picture = camera.make_opaque(), seen.size[::-1]
    valid = np.array(seen.si.is_valid())
    # Of a map of one texel the area in pixels is the number of texels that match them
    count = np.array(texel_area_in_pixels((opaque, 1), picture, seen.si.p, seen.si.n))[valid]
    levels = np.ceil(np.log2(np.maximum(np.sqrt(count) / page, 1)))
    x, y, _ = opaque.project(*seen.si.p)
    return np.array([x, y]).T[valid], np.minimum(levels, FINEST).astype(int)


def select_leaf(places, leaf):
    """Return the mask (n,) of the places within a leaf: its level, row and column."""
    level, row, column = leaf
    cells = np.clip((places + 1) / 2 * 2**level, 0, 2**level - 1).astype(int)
    return (cells[:, 0] == column) & (cells[:, 1] == row)


def grow_leaves(places, levels, leaf=(0, 0, 0)):
    """Return the leaves of the quadtree in which no place needs a finer level than its leaf's."""
    level, row, column = leaf
    if not (levels > level).any():
        return [leaf]
    leaves = []
    for i, j in np.ndindex(2, 2):
        child = level + 1, 2 * row + i, 2 * column + j
        within = select_leaf(places, child)
        leaves += grow_leaves(places[within], levels[within], child)
    return leaves


def claim_better(found):
    gains = {cell: its["matched"] - its["one map"] for cell, its in found.items()}
    ours, verdict = judge_over_grid(SETTINGS, {cell: bool(g > 0) for cell, g in gains.items()})
    return Claim(
        "A partition of the light's map improves shadows: resolution-matched maps.",
        "2.2.3, 2.2.3.2",
        "the statement",
        f"{ours}; {min(gains.values()):+.1f} to {max(gains.values()):+.1f} dB",
        verdict,
        "Against one focused map with as many texels.",
    )


def claim_analysis(found):
    shares = [its["texels"] / its["pixels"] for its in found.values()]
    pages = [its["pages"] for its in found.values()]
    return Claim(
        "What costs most is the analysis of the scene.",
        "2.2.3.2",
        "no figure",
        f"{min(shares):.1f} to {max(shares):.1f} texels are drawn, in {min(pages)} to "
        f"{max(pages)} pages, for each pixel that is analysed",
        NOT_RUN,
        "By counted work the maps would cost most. But the thesis speaks of pixels that are read "
        "back and sorted, which was slow in 2008, and which no processor of today can tell.",
    )
