"""Writes sentences on where fits of real measurements fail, and why."""

from collections import Counter
from itertools import pairwise
from statistics import median

from brdfkit.core.names import join_words

DEFAULT = "cbrt"
UNKNOWN = "No reason was found."
# A model without a Fresnel term, whose albedo hardly depends on the angle of incidence
FLAT = "ward_duer"
# A fit fails if its albedo is wrong by more than this factor, or its PSNR [dB] is lower than this
OFF, POOR = 1.25, 30.0
# A larger share of negative values is mentioned as a reason
NEGATIVE = 0.05
# A highlight changes its hue if a channel's share moves away from an equal share by more than this
SHIFT = 0.06
# Below this mean factor of brightness a fit counts as neither too bright nor too dark
EVEN = 1.05
# Words in findings of `brdfkit.audit` that explain a failure
TELLING = "retroreflective", "spike", "not reciprocal", "more light leaves than arrives"
REGIONS = {
    "mirror": "pairs whose half vector is within 10° of the normal",
    "back": "pairs within 20° of each other, towards the light",
    "grazing": "pairs with a direction more than 65° from the normal",
    "other": "pairs that are in no highlight and do not graze",
}
TEXT = """Files with a fit whose light is more than 25 % off at 5° or 45°, by any model and loss, or
whose best picture by the default loss has less than 30 dB. What `brdfkit info` finds doubtful is in
quotation marks. The last sentence says where the log error of the best picture's fit comes from."""
GRAZING = """### Light at 75° alone

Other files, on which fits are off at 75° alone, by what explains it."""


def list_failures(files):
    """Return a list of the files on which fits fail, with the reasons."""
    lines = []
    for found in files.values():
        off = find_wrong_fits(found, angles=2)
        model, fit = find_best_picture(found)
        if off or fit["psnr"] < POOR:
            what = [f"light of {_format_wrong_fits(off)}"] if off else []
            what.append(f"{fit['psnr']:.1f} dB at best, by `{model}`")
            sentences = [*explain_failure(found, off), locate_log_error(found, model)]
            lines.append(f"- **{found['name']}** ({'; '.join(what)}). {' '.join(sentences)}")
    return "\n".join(lines) or "There are none."


def list_grazing_failures(files):
    """Return a list of the files on which fits fail at 75° alone, grouped by reason."""
    groups = {}
    for found in files.values():
        off = [row for row in find_wrong_fits(found, angles=3) if row[0] != FLAT]
        if (
            off
            and not find_wrong_fits(found, angles=2)
            and find_best_picture(found)[1]["psnr"] >= POOR
        ):
            groups.setdefault(" ".join(explain_failure(found, off)), []).append(
                (found["name"], off)
            )
    lines = [describe_flat_model(files)]
    for sentences, rows in groups.items():
        names = join_words([name for name, _ in rows])
        fits = [row for _, off in rows for row in off]
        losses = Counter(loss for _, loss, _ in fits)
        counts = join_words([f"{count} by `{loss}`" for loss, count in losses.most_common()])
        factor = max((factor for *_, factor in fits), key=lambda f: max(f, 1 / f))
        lines.append(f"- **{names}** ({counts}; ×{factor:.2f} at most). {sentences or UNKNOWN}")
    return "\n".join(lines)


def find_wrong_fits(found, angles):
    """Return (model, loss, factor) of the fits to a file whose albedo is wrong.

    `found`: results of the file; `angles`: number of the first angles of incidence that count.
    """
    return [
        (model, loss, find_largest_factor(found, fit))
        for model, by_loss in found["fits"].items()
        for loss, fit in by_loss.items()
        if is_light_wrong(found, fit, angles)
    ]


def describe_flat_model(files):
    """Return a sentence on the albedo at 75° of the model without a Fresnel term."""
    fits = [(found, fit) for found in files.values() for fit in found["fits"][FLAT].values()]
    off = [f for f, fit in fits if is_light_wrong(f, fit) and not is_light_wrong(f, fit, angles=2)]
    rise = median(found["albedo"][2] / found["albedo"][0] for found in off) if off else 1.0
    return (
        f"- **`{FLAT}`**, on any file ({len(off)} of its {len(fits)} fits). It has no Fresnel "
        "term, so that its albedo hardly depends on the angle; that of these files is at 75° "
        f"{rise:.2g} times that at 5°, in the median."
    )


def compute_light_factors(found, fit, angles=3):
    """Return the ratios of a fit's albedos to the data's, at the first `angles` that are known."""
    rows = zip(found["albedo"], found["known"], fit["albedo"], strict=True)
    return [own / its for its, known, own in list(rows)[:angles] if known]


def is_light_wrong(found, fit, angles=3):
    """Return whether the albedo of a fit is wrong at one of the first `angles`."""
    return any(max(f, 1 / f) > OFF for f in compute_light_factors(found, fit, angles))


def find_best_picture(found):
    """Return (model, results of its fit) with the best picture by the default loss."""
    fits = {model: by_loss[DEFAULT] for model, by_loss in found["fits"].items()}
    return max(fits.items(), key=lambda item: item[1]["psnr"])


def find_largest_factor(found, fit):
    """Return the ratio of a fit's albedo to the data's at the angle where it is farthest from 1."""
    return max(compute_light_factors(found, fit), key=lambda f: max(f, 1 / f), default=1.0)


def _format_wrong_fits(off):
    """Return a text of the fits with a wrong albedo: models with losses and factors."""
    models = {}
    for model, loss, factor in off:
        models.setdefault(model, []).append(f"`{loss}` ×{factor:.2f}")
    return ", ".join(f"`{model}` by {join_words(losses)}" for model, losses in models.items())


def explain_failure(found, off):
    """Return sentences on properties of a file's data that explain why fits fail.

    `found`: results of the file; `off`: its fits with a wrong albedo.
    """
    sentences = [
        f"“{finding[0].upper()}{finding[1:].rstrip('.')}.”"
        for finding in found["findings"]
        if any(words in finding for words in TELLING)
    ]
    if found["negative"] > NEGATIVE:
        sentences.append(
            f"{format_percent(found['negative'])} of the values in linear sRGB are negative, of "
            "colours that sRGB does not hold; weights are not negative, so that fits are paler."
        )
    if (turn := _describe_hue_change(found["hues"])) is not None:
        sentences.append(
            f"Its highlight changes its hue: {turn}; a lobe has one colour, which grazing angles "
            "only make paler."
        )
    least = min(found["reach"])
    if off and least < 75:
        sentences.append(
            f"No pair was measured with both directions beyond {least:.0f}°: at 75° the measured "
            "material is extrapolated, and so is the fit."
        )
    return sentences


def _describe_hue_change(hues):
    """Return in words how the hue of a highlight changes, or None if it only becomes paler."""
    even = 1 / len(hues[0])
    for first, later in pairwise(hues):
        for channel, own, next_ in zip("RGB", first, later, strict=False):
            if abs(next_ - even) > abs(own - even) + SHIFT:
                before, after = format_percent(own), format_percent(next_)
                return f"the share of {channel} goes from {before} to {after}"
    return None


def locate_log_error(found, model):
    """Return a sentence on the region of directions with most of the fit's log error."""
    name, (share, factor) = max(found["regions"].items(), key=lambda item: item[1][0])
    size = max(factor, 1 / factor)
    how = f"{size:.2g} times too {'bright' if factor > 1 else 'dark'} in the mean"
    if size < EVEN:
        how = "too bright at some and too dark at others"
    return (
        f"{format_percent(share)} of the squares are of {REGIONS[name]}; there `{model}` is {how}."
    )


def format_percent(share, digits=0):
    """Return a share as text in per cent, with a space before the sign."""
    return f"{share:.{digits}%}".replace("%", " %")
