"""Table 4: what three filters of LiSPSM differ from exact shadows."""

import numpy as np

from brdfkit.jit.llvm import use_variant
from brdfkit.jit.threads import in_turn
from brdfkit.reproducing.claims import Claim, verdict
from brdfkit.reproducing.drawing import figure
from brdfkit.reproducing.ergun2008.printed import mean_and_relative, printed
from brdfkit.reproducing.ergun2008.views import View, measured
from brdfkit.reproducing.page import Picture, Section, Table
from brdfkit.shadow_maps.scenes import VIEWS

SECONDS = 20
SCENES = ()  # by default all
FILTERS = {"depth": "depth map", "percentage_closer": "PCF", "variance": "VSM"}
PROJECTION = "light_space_perspective"
TEXT = """Maps by LiSPSM, against exact shadows, which are those of the stencil (see above): PSNR of
the pixels that face the light. PCF and VSM are over windows of 5 × 5 texels; the thesis tells
neither its PCF nor the blur of its VSM."""


@in_turn
def run(sources, report):
    """The errors, and the claims on them."""
    use_variant()
    found = measured(errors, SCENES, report)
    table = {
        scene: np.array([mean_and_relative(cells[..., i]) for i in range(len(FILTERS))])
        for scene, cells in found.items()
    }
    claims = [
        order_claim(table),
        gain_claim(table),
        softness_claim(table),
        relative_claim(table),
    ]
    rows = [
        (name, score, *(f"{values[i, k]:.2f}" for values in (printed_table(), *table.values())))
        for k, score in enumerate(("PSNR [dB]", "relative [dB]"))
        for i, name in enumerate(FILTERS.values())
    ]
    cells = [
        (
            scene,
            name,
            *(" / ".join(f"{v:.1f}" for v in q[view, :, i]) for view in range(len(VIEWS))),
        )
        for scene, q in found.items()
        for i, name in enumerate(FILTERS.values())
    ]
    tables = [
        Table(("filter", "score", "printed", *table), rows),
        Table(("scene", "filter", *VIEWS), cells, "PSNR [dB] in light 1 / light 2."),
    ]
    caption = "Exact shadows, and those by LiSPSM with each filter; view V3."
    return Section(
        "Table 4: filters", TEXT, claims, tables, [Picture("table_4", draw(), caption)]
    )


def errors(view):
    """PSNR [dB] by filter."""
    return [
        view.psnr(view.lit(view.shadow(projection=PROJECTION, filter=name))) for name in FILTERS
    ]


def printed_table():
    return np.array(list(printed("table_4").values()))


def order(values):
    """The filters, the one with most PSNR first, in words."""
    return " > ".join(list(FILTERS.values())[i] for i in np.argsort(-values[:, 0]))


def order_claim(table):
    ours = {scene: order(values) for scene, values in table.items()}
    expected = order(printed_table())
    return Claim(
        "The filter nearest to exact shadows.",
        "Table 4, 5",
        expected,
        "; ".join(f"{scene}: {words}" for scene, words in ours.items()),
        verdict(set(ours.values()) == {expected}),
    )


def gain_claim(table):
    gains = [values[2, 0] - values[0, 0] for values in table.values()]
    return Claim(
        "VSM is far nearer to them than a plain depth map.",
        "Table 4",
        "10.1 dB more",
        ", ".join(f"{scene} {gain:+.1f} dB" for scene, gain in zip(table, gains, strict=True)),
        verdict(min(gains) > 3),
        "Confirmed from 3 dB. The thesis's depth map may have had acne or a bias too large, which "
        "VSM hides; ours has neither, and then softening the edges brings only what an average of "
        "steps does.",
    )


def softness_claim(table):
    losses = [values[1, 0] - values[0, 0] for values in table.values()]
    return Claim(
        "PCF is farther from them than a plain depth map, for its edges are soft.",
        "Table 4",
        "2.05 dB less",
        ", ".join(f"{scene} {loss:+.1f} dB" for scene, loss in zip(table, losses, strict=True)),
        verdict(max(losses) < 0),
        "A texel on an edge is wrong by half a texel by either; a soft edge spreads the error over "
        "more pixels and halves its height, which squares make smaller.",
    )


def relative_claim(table):
    steadiest = [bool(values[2, 1] == values[:, 1].max()) for values in table.values()]
    return Claim(
        "VSM changes most from light to light.",
        "Table 4",
        "5.29 dB, depth map 2.17, PCF 2.23",
        "; ".join(
            f"{scene} {values[2, 1]:.2f}, {values[0, 1]:.2f}, {values[1, 1]:.2f} dB"
            for scene, values in table.items()
        ),
        verdict(all(steadiest)),
        "In the printed cells V1 alone, 45.43 and 60.57 dB, makes 3.8 of the 5.3 dB.",
    )


def draw():
    """The pictures of one view."""
    view = View.of("objects_on_a_ground", "V3", 1)
    lit = {"exact": view.seen.exact} | {
        FILTERS[name]: view.lit(view.shadow(projection=PROJECTION, filter=name))
        for name in FILTERS
    }
    drawn = figure(10, 2.8)
    most = view.seen.picture(np.ones(len(view.seen.exact))).max()
    for axes, (name, shares) in zip(drawn.subplots(1, len(lit)), lit.items(), strict=True):
        picture = view.seen.picture(0.85 * shares + 0.15) / most
        axes.imshow(picture.clip(0, 1) ** (1 / 2.2))
        axes.set_title(name, size=10)
        axes.set_axis_off()
    return drawn
