"""The page of the losses: the errors of pictures of `make_losses.py`, in tables and words."""

from collections import Counter, defaultdict
from pathlib import Path
from statistics import mean, median

from leaderboard.page import made_with
from make_models import paragraphs, table

from brdfkit.core.names import join_words
from brdfkit.regression.losses.named_losses import DEFAULT
from brdfkit.theses.drawing import COLOURS, figure, tidy

PAGE = Path(__file__).parents[1] / "losses.md"
# The losses that the figure shows, and the difference that is clear [dB]
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
    """Write the page of `rows`, dictionaries of material, model, loss, floor and errors."""
    found = by_fit(rows)
    facts = {
        "losses": join_words([f"`{loss}`" for loss in dict.fromkeys(row["loss"] for row in rows)]),
        "count": len({row["material"] for row in rows}),
        "until": until,
        "floor": min(row["floor"] for row in rows),
        "size": size,
        "versions": made_with(),
    }
    text = paragraphs(
        "# Which loss looks best",
        INTRODUCTION.format(**facts),
        *("## The answer", advice(found)),
        *("## Means over all materials", MEANS, means(found)),
        "![How much better than by the default loss each material looks](losses.png)",
        *("## How often each loss is best", WINS, wins(found)),
        *("## Each material", EACH, each(found)),
    )
    PAGE.write_text(text, encoding="utf-8")
    draw(found).savefig(PAGE.with_suffix(".png"), dpi=90)


def by_fit(rows):
    """Model → loss → material → errors."""
    found = defaultdict(lambda: defaultdict(dict))
    for row in rows:
        found[row["model"]][row["loss"]][row["material"]] = row
    return found


def mean_of(materials, metric="psnr"):
    return mean(row[metric] for row in materials.values())


MEANS = """PSNR [dB] of linear pixels, its peak the 99.9th percentile; ΔE2000 of what a screen
shows, its median over the ball; FLIP of high dynamic range. Each is the mean over the materials,
and the best of a model is bold."""


def means(found):
    """The mean errors of every model by every loss."""
    metrics = (("psnr", ".1f", max), ("delta_e_2000", ".2f", min), ("flip", ".3f", min))
    losses = list(next(iter(found.values())))
    rows = []
    for model, by_loss in found.items():
        for metric, digits, best in metrics:
            values = {loss: mean_of(materials, metric) for loss, materials in by_loss.items()}
            top = best(values.values())
            cells = [f"{values[loss]:{digits}}" for loss in losses]
            cells = [
                f"**{c}**" if values[loss] == top else c
                for c, loss in zip(cells, losses, strict=True)
            ]
            rows.append((f"`{model}`", {"psnr": "PSNR", "flip": "FLIP"}.get(metric, "ΔE"), *cells))
    return table(", ".join(["model", "mean", *losses]), rows)


WINS = """On how many materials the picture of each loss has the highest PSNR of all losses, and how
often it is lower than the default loss's by more than 0.5 dB."""


def wins(found):
    """How often each loss is the best one, and how often clearly worse than the default."""
    losses = list(next(iter(found.values())))
    rows = []
    for model, by_loss in found.items():
        best = Counter(
            max(losses, key=lambda loss: by_loss[loss][material]["psnr"])
            for material in by_loss[DEFAULT]
        )
        cells = [f"{best[loss]} ({worse(by_loss, loss)})" for loss in losses]
        rows.append((f"`{model}`", *cells))
    return table(", ".join(["model", *losses]), rows)


def gains(by_loss, loss, other=DEFAULT):
    """By how many dB each material's picture is better than by another loss."""
    return {
        material: row["psnr"] - by_loss[other][material]["psnr"]
        for material, row in by_loss[loss].items()
    }


def worse(by_loss, loss):
    return sum(gain < -CLEAR for gain in gains(by_loss, loss).values())


def advice(found):
    """Which loss looks best, and how every other does beside the default, in words with figures."""
    losses = list(next(iter(found.values())))
    overall = {loss: mean(mean_of(by[loss]) for by in found.values()) for loss in losses}
    best = max(losses, key=overall.get)
    means_ = ", ".join(f"`{loss}` {overall[loss]:.1f}" for loss in sorted(losses, key=overall.get))
    lead = min(mean_of(by[best]) - mean_of(by[DEFAULT]) for by in found.values())
    verdict = "clearly" if lead > CLEAR else "but not clearly"
    lines = [f"By the mean PSNR of all models `{best}` looks best, {verdict}: {means_} dB."]
    for loss in losses[1:]:
        lines += ["", f"`{loss}` beside `{DEFAULT}`:", ""]
        lines += [f"- `{model}`: {beside(by, loss)}" for model, by in found.items()]
    return "\n".join(lines)


def beside(by_loss, loss):
    """How the pictures of one model by a loss do beside those by the default, in words."""
    ends = gains(by_loss, loss)
    low, high = (f"{ends[m]:+.1f} ({m})" for m in (f(ends, key=ends.get) for f in (min, max)))
    return (
        f"{mean(ends.values()):+.2f} dB in the mean, {median(ends.values()):+.2f} in the median, "
        f"from {low} to {high}; worse by more than {CLEAR:g} dB on {worse(by_loss, loss)} of "
        f"{len(ends)}"
    )


EACH = """PSNR [dB] of `ggx` by each loss, and the best loss of the best model."""


def each(found):
    """The PSNR of every material."""
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
    return table(", ".join(["material", *losses, "best", "PSNR"]), rows)


def draw(found):
    """The figure: gains over the default loss of all materials, sorted, a panel for each model."""
    drawn = figure(3.2 * len(found), 3.0)
    panels = drawn.subplots(1, len(found), sharey=True, squeeze=False)[0]
    for axes, (model, by_loss) in zip(panels, found.items(), strict=True):
        for loss, colour in zip(DRAWN[1:], COLOURS, strict=False):
            if loss in by_loss:
                values = sorted(gains(by_loss, loss).values())
                axes.plot(range(1, len(values) + 1), values, label=loss, color=colour)
        axes.axhline(0, color="0.3", linewidth=0.8)
        tidy(axes, model, "")
        axes.set_xlabel("materials, sorted")
    panels[0].set_ylabel("PSNR beside the default loss [dB]")
    panels[0].legend(frameon=False)
    return drawn
