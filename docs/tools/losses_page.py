"""Writes the page of the losses and its figure, from the errors of `make_losses.py`."""

from collections import Counter, defaultdict
from pathlib import Path
from statistics import mean, median

from leaderboard.page import describe_versions
from make_models import join_paragraphs, make_table

from brdfkit.core.names import join_words
from brdfkit.regression.losses.named_losses import DEFAULT
from brdfkit.theses.drawing import COLOURS, make_figure, style_axes

PAGE = Path(__file__).parents[1] / "losses.md"
# The losses that the figure shows, and the difference from which on one is clearly better [dB]
DRAWN, CLEAR = (DEFAULT, "log", "picture", "cosine"), 0.5
INTRODUCTION = """A fit by another loss is another picture. Here the same models are fitted to
{count} materials by {losses}, and each fit is path-traced beside the measurement, on the
ball that `brdfkit render` shows. Made by `BRDFKIT_DATA=FOLDER python docs/tools/make_losses.py
--cache CACHE`; FOLDER holds third-party files, which brdfkit does not ship.

The materials are every fifth of the neural reconstructions that stand for MERL's tables [Sztrajman
et al. 2021], in tables of 60×30×60 cells. What each loss is a mean over:
[fitting](theory/fitting.md#losses). Samples were added until the measurement beside itself, with
another seed, has a PSNR of {until:g} dB (least: {floor:.1f} dB), at {size}×{size} pixels.

{versions}; seed 0."""


def write_page(rows, until, size):
    """Write the page of `rows`, dictionaries of material, model, loss, noise floor and errors.

    `until`: noise floor of the pictures [dB]; `size`: their side [pixels].
    """
    found = group_rows(rows)
    facts = {
        "losses": join_words([f"`{loss}`" for loss in dict.fromkeys(row["loss"] for row in rows)]),
        "count": len({row["material"] for row in rows}),
        "until": until,
        "floor": min(row["floor"] for row in rows),
        "size": size,
        "versions": describe_versions(),
    }
    text = join_paragraphs(
        "# Which loss looks best",
        INTRODUCTION.format(**facts),
        *("## The answer", write_advice(found)),
        *("## Means over all materials", MEANS, make_means_table(found)),
        "![How much better than by the default loss each material looks](losses.png)",
        *("## How often each loss is best", WINS, make_wins_table(found)),
        *("## Each material", EACH, make_materials_table(found)),
    )
    PAGE.write_text(text, encoding="utf-8")
    draw_gains(found).savefig(PAGE.with_suffix(".png"), dpi=90)


def group_rows(rows):
    """Return the rows of errors in nested dictionaries by model, loss and material."""
    found = defaultdict(lambda: defaultdict(dict))
    for row in rows:
        found[row["model"]][row["loss"]][row["material"]] = row
    return found


def average_errors(materials, metric="psnr"):
    return mean(row[metric] for row in materials.values())


MEANS = """PSNR [dB] of linear pixels, its peak the 99.9th percentile; ΔE2000 of what a screen
shows, its median over the ball; FLIP of high dynamic range. Each is the mean over the materials,
and the best of a model is bold."""


def make_means_table(found):
    """Return the table of the mean errors of each model by each loss."""
    metrics = (("psnr", ".1f", max), ("delta_e_2000", ".2f", min), ("flip", ".3f", min))
    losses = list(next(iter(found.values())))
    rows = []
    for model, by_loss in found.items():
        for metric, digits, best in metrics:
            values = {
                loss: average_errors(materials, metric) for loss, materials in by_loss.items()
            }
            top = best(values.values())
            cells = [f"{values[loss]:{digits}}" for loss in losses]
            cells = [
                f"**{c}**" if values[loss] == top else c
                for c, loss in zip(cells, losses, strict=True)
            ]
            rows.append((f"`{model}`", {"psnr": "PSNR", "flip": "FLIP"}.get(metric, "ΔE"), *cells))
    return make_table(", ".join(["model", "mean", *losses]), rows)


WINS = """On how many materials the picture of each loss has the highest PSNR of all losses, and how
often it is lower than the default loss's by more than 0.5 dB."""


def make_wins_table(found):
    """Return the table of how often each loss is best, or clearly worse than the default."""
    losses = list(next(iter(found.values())))
    rows = []
    for model, by_loss in found.items():
        best = Counter(
            max(losses, key=lambda loss: by_loss[loss][material]["psnr"])
            for material in by_loss[DEFAULT]
        )
        cells = [f"{best[loss]} ({count_worse(by_loss, loss)})" for loss in losses]
        rows.append((f"`{model}`", *cells))
    return make_table(", ".join(["model", *losses]), rows)


def compute_gains(by_loss, loss, other=DEFAULT):
    """Return by how many dB the pictures by a loss are better than by another, by material."""
    return {
        material: row["psnr"] - by_loss[other][material]["psnr"]
        for material, row in by_loss[loss].items()
    }


def count_worse(by_loss, loss):
    return sum(gain < -CLEAR for gain in compute_gains(by_loss, loss).values())


def write_advice(found):
    """Return sentences on which loss gives the best pictures, and how the others compare."""
    losses = list(next(iter(found.values())))
    overall = {loss: mean(average_errors(by[loss]) for by in found.values()) for loss in losses}
    best = max(losses, key=overall.get)
    means_ = ", ".join(f"`{loss}` {overall[loss]:.1f}" for loss in sorted(losses, key=overall.get))
    lead = min(average_errors(by[best]) - average_errors(by[DEFAULT]) for by in found.values())
    verdict = "clearly" if lead > CLEAR else "but not clearly"
    lines = [f"By the mean PSNR of all models `{best}` looks best, {verdict}: {means_} dB."]
    for loss in losses[1:]:
        lines += ["", f"`{loss}` beside `{DEFAULT}`:", ""]
        lines += [f"- `{model}`: {describe_gains(by, loss)}" for model, by in found.items()]
    return "\n".join(lines)


def describe_gains(by_loss, loss):
    """Return in words how a model's pictures by a loss compare with those by the default."""
    ends = compute_gains(by_loss, loss)
    low, high = (f"{ends[m]:+.1f} ({m})" for m in (f(ends, key=ends.get) for f in (min, max)))
    return (
        f"{mean(ends.values()):+.2f} dB in the mean, {median(ends.values()):+.2f} in the median, "
        f"from {low} to {high}; worse by more than {CLEAR:g} dB on {count_worse(by_loss, loss)} of "
        f"{len(ends)}"
    )


EACH = """PSNR [dB] of `ggx` by each loss, and the best loss of the best model."""


def make_materials_table(found):
    """Return the table of the PSNR of every material."""
    losses = list(found["ggx"])
    rows = []
    for material in sorted(found["ggx"][DEFAULT]):
        cells = [f"{found['ggx'][loss][material]['psnr']:.1f}" for loss in losses]
        top = max(
            (
                (by[loss][material]["psnr"], model, loss)
                for model, by in found.items()
                for loss in by
            ),
        )
        rows.append((material, *cells, f"`{top[1]}` by `{top[2]}`", f"{top[0]:.1f}"))
    return make_table(", ".join(["material", *losses, "best", "PSNR"]), rows)


def draw_gains(found):
    """Return the figure of sorted gains over the default loss, with a panel for each model."""
    drawn = make_figure(3.2 * len(found), 3.0)
    panels = drawn.subplots(1, len(found), sharey=True, squeeze=False)[0]
    for axes, (model, by_loss) in zip(panels, found.items(), strict=True):
        for loss, colour in zip(DRAWN[1:], COLOURS, strict=False):
            if loss in by_loss:
                values = sorted(compute_gains(by_loss, loss).values())
                axes.plot(range(1, len(values) + 1), values, label=loss, color=colour)
        axes.axhline(0, color="0.3", linewidth=0.8)
        style_axes(axes, model, "")
        axes.set_xlabel("materials, sorted")
    panels[0].set_ylabel("PSNR beside the default loss [dB]")
    panels[0].legend(frameon=False)
    return drawn
