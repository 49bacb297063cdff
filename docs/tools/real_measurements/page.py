"""Writes the page of real measurements, from the results of `make_real_measurements.py`."""

from pathlib import Path
from statistics import median

from leaderboard.page import describe_versions
from make_models import join_paragraphs, make_table
from real_measurements import five, reasons
from real_measurements.reasons import (
    DEFAULT,
    find_best_picture,
    find_largest_factor,
    format_percent,
    is_light_wrong,
)

PAGE = Path(__file__).parents[2] / "real_measurements.md"
# A fit with a larger albedo gains light; the quadrature has smaller errors
GAIN = 1.005
INTRODUCTION = """Whether a fit of a file, as an instrument gives it, is right: its light, its
picture, and whether another file of the same material gives the same fit. Made by
`BRDFKIT_DATA=FOLDER python docs/tools/make_real_measurements.py`; FOLDER holds third-party files,
which brdfkit does not ship.

{versions}; seed 0."""
LOSSES = """## What a loss sums over

A loss is no sum over a file's samples, but an integral over all pairs of directions below 80° to
the normal, which the samples estimate. Each sample counts by how much of a *measure* of the pairs
it stands for: of the solid angles of both directions by the losses `cosine` and `plain`, in which a
highlight is small; of the half and difference angles by `log`, in which it is large; and of the
geometric mean of the two by `cbrt`, the default. Tables and RGL grids know what each of their
samples stands for. Of scattered samples it is estimated: points are spread over all pairs, and each
belongs to the nearest sample, if one is near.

`Fit.unrepresented` is the share of the measure that no sample stands for, because none is near:
there the data say nothing, and the model alone decides. It is no warning that samples are too few
for a highlight. `Fit.effective_samples` says how many samples of equal weight would tell as much. A
fit whose light departs from its data's is searched again with a term for it, which is kept unless
the error grows too much; what is still wrong is said in the fit's notes and its message."""
FILES = """The files are RGL's adaptive grids [Dupuy & Jakob 2018], goniometer data of paints
[Mini-Diff], of Cornell and of ALTA's retroreflecting tapes, and every tenth sample of CUReT
[Dana et al. 1999]: measurements all, no reconstructions.

*Light*: the albedo of a fit over that of the measured material, which is looked up between its
samples; by `brdfkit.albedo`, apart from any fit. *Near*: fits within 25 % at 5° and at 45°.
*Off*: fits farther off at 5°, 45° or 75°, and of these how many say so. *Gains*: fits that reflect
more than arrives at one of these angles, or at 30°, 60°, 80°, 85° or 89°, and how many say so."""
PICTURES = """PSNR [dB] of a ball beside the measured material itself, in the median and at least,
under the maps `room`, `sky` and `studio` in grey. Its pixels are sums over pairs of directions,
drawn once for a file and the same for all fits, so that they differ by no noise; they are about
half a dB from sums over many more. The measurement is exposed so that its brightest hundredth is
white, the fit as the measurement, and both as a screen shows them. Below it, the median error of
the log loss."""
EACH = """PSNR [dB] by the default loss, `cbrt`; where the light is off by more than 25 % at 5°, 45°
or 75°, the factor where it is farthest off. *Albedo*: that of the measured material there."""
BALLS = """![Eight of the files, measured and fitted](real_measurements.jpg)

*Left as measured, then fitted by the default loss, path-traced.*"""


def write_page(results):
    """Write the page of the `results`, of which a part may be missing."""
    files, materials = results.get("files"), results.get("invariance")
    text = ["# Real measurements", INTRODUCTION.format(versions=describe_versions()), "## In short"]
    text += ["\n".join(write_verdict(results)), LOSSES]
    if files:
        text += ["## Files as instruments give them", FILES, make_light_table(files), PICTURES]
        text += [make_pictures_table(files), "## Each file", EACH, make_files_table(files), BALLS]
        text += ["## Where it fails, and why", reasons.TEXT]
        text += [
            reasons.list_failures(files),
            reasons.GRAZING,
            reasons.list_grazing_failures(files),
        ]
    if materials:
        text += [
            "## The same material as five files",
            five.TEXT,
            five.make_sameness_table(materials),
        ]
        text += [five.make_coverage_table(materials)]
        text += [
            "### What differs, and why",
            five.make_causes_table(materials),
            five.list_open_cases(materials),
        ]
    PAGE.write_text(join_paragraphs(*text), encoding="utf-8")


def write_verdict(results):
    """Return sentences that sum up the results, with numbers."""
    files, materials = results.get("files"), results.get("invariance")
    lines = []
    if files:
        rows = list(iterate_fits(files))
        near = [not is_light_wrong(found, fit, angles=2) for found, fit, *_ in rows]
        off = [fit["said"] for found, fit, *_ in rows if is_light_wrong(found, fit)]
        gains = [fit["gain said"] for _, fit, *_ in rows if fit["most"] > GAIN]
        default = [fit["psnr"] for _, fit, _, loss in rows if loss == DEFAULT]
        top = [find_best_picture(found)[1]["psnr"] for found in files.values()]
        lines += [
            f"- **Light.** {format_percent(sum(near) / len(rows), 1)} of {len(rows)} fits to "
            f"{len(files)} files reflect within 25 % of what their data reflect, at 5° and at 45°.",
            f"- **Nothing unsaid.** {len(off)} fits are farther off at 5°, 45° or 75°, and "
            f"{format_count(off)} say so; {len(gains)} reflect more than arrives at one of these "
            f"angles, or at 30°, 60°, 80°, 85° or 89°, and {format_count(gains)} say so.",
            f"- **Pictures.** By the default loss a ball has a PSNR of {median(default):.1f} dB in "
            f"the median of all models, and {median(top):.1f} dB by the best model of each file.",
        ]
    return lines + (five.write_verdict(materials) if materials else [])


def iterate_fits(files):
    """Yield (results of the file, results of the fit, model, loss) for all fits."""
    for found in files.values():
        for model, by_loss in found["fits"].items():
            for loss, fit in by_loss.items():
                yield found, fit, model, loss


def format_count(truths):
    """Return in words how many of some truth values are true, as "all" or "3 of 5"."""
    return "all" if truths and all(truths) else f"{sum(truths)} of {len(truths)}"


def group_by_model(files):
    """Return lists of pairs (results of the file, of the fit) by (model, loss)."""
    found = {}
    for about, fit, model, loss in iterate_fits(files):
        found.setdefault((model, loss), []).append((about, fit))
    return found


def make_light_table(files):
    """Return the table on how well the albedos of fits agree with the data, by model and loss."""
    rows = []
    for (model, loss), pairs in group_by_model(files).items():
        near = [not is_light_wrong(found, fit, angles=2) for found, fit in pairs]
        off = [fit["said"] for found, fit in pairs if is_light_wrong(found, fit)]
        gains = [fit["gain said"] for _, fit in pairs if fit["most"] > GAIN]
        again = sum(fit["searched again"] for _, fit in pairs)
        counts = (f"{len(found)} ({sum(found)})" if found else "0" for found in (off, gains))
        rows.append(
            (f"`{model}`", f"`{loss}`", format_percent(sum(near) / len(near), 1), *counts, again)
        )
    return make_table("model, loss, near, off (said), gains (said), searched again", rows)


def make_pictures_table(files):
    """Return the table of the PSNR of balls and the log errors, by model and loss."""
    models = {}
    for (model, loss), pairs in group_by_model(files).items():
        models.setdefault(model, {})[loss] = [fit for _, fit in pairs]
    losses, rows = list(next(iter(models.values()))), []
    for model, by_loss in models.items():
        values = [[fit["psnr"] for fit in by_loss[loss]] for loss in losses]
        rows.append(
            (f"`{model}`", "PSNR (least)", *(f"{median(v):.1f} ({min(v):.1f})" for v in values))
        )
        values = [[fit["log error"] for fit in by_loss[loss]] for loss in losses]
        rows.append((f"`{model}`", "log error", *(f"{median(v):.3f}" for v in values)))
    return make_table(", ".join(["model", "median", *(f"`{loss}`" for loss in losses)]), rows)


def make_files_table(files):
    """Return the table of each file's PSNR and albedo errors by the default loss."""
    rows = []
    for name, found in files.items():
        cells = []
        for by_loss in found["fits"].values():
            fit = by_loss[DEFAULT]
            off = f" (×{find_largest_factor(found, fit):.2f})" if is_light_wrong(found, fit) else ""
            cells.append(f"{fit['psnr']:.1f}{off}")
        albedo = " ".join(f"{a:.2f}" for a in found["albedo"])
        rows.append((found["name"], name.partition("/")[0], albedo, *cells))
    models = [f"`{model}`" for model in next(iter(files.values()))["fits"]]
    return make_table(", ".join(["file", "folder", "albedo", *models]), rows)
