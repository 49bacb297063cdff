"""Where fits of real measurements fail, and why: sentences, by the figures of the files."""

from collections import Counter
from itertools import pairwise
from statistics import median

from brdfkit.core.names import join_words

DEFAULT = "cbrt"
UNKNOWN = "No reason was found."
# The model without a Fresnel term, whose albedo hardly depends on the angle
FLAT = "ward_duer"
# The factor by which the light of a fit is off, and a picture [dB] that differs visibly
OFF, POOR = 1.25, 30.0
# The share of negative values that tells
NEGATIVE = 0.05
# By how much the share of a channel in a highlight moves away from an even one
SHIFT = 0.06
# The mean factor of brightness below which a fit is neither too bright nor too dark
EVEN = 1.05
# The findings of `brdfkit.audit` that explain a failure, by words in them
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


def failures(files):
    """The files on which fits fail, with the reasons."""
    lines = []
    for found in files.values():
        off = fits_off(found, angles=2)
        model, fit = best(found)
        if off or fit["psnr"] < POOR:
            what = [f"light of {_name(off)}"] if off else []
            what.append(f"{fit['psnr']:.1f} dB at best, by `{model}`")
            sentences = [*why(found, off), where(found, model)]
            lines.append(f"- **{found['name']}** ({'; '.join(what)}). {' '.join(sentences)}")
    return "\n".join(lines) or "There are none."


def grazing(files):
    """How the light of fits to other files is at 75°, by reasons."""
    groups = {}
    for found in files.values():
        off = [row for row in fits_off(found, angles=3) if row[0] != FLAT]
        if off and not fits_off(found, angles=2) and best(found)[1]["psnr"] >= POOR:
            groups.setdefault(" ".join(why(found, off)), []).append((found["name"], off))
    lines = [flat(files)]
    for sentences, rows in groups.items():
        names = join_words([name for name, _ in rows])
        fits = [row for _, off in rows for row in off]
        losses = Counter(loss for _, loss, _ in fits)
        counts = join_words([f"{count} by `{loss}`" for loss, count in losses.most_common()])
        factor = max((factor for *_, factor in fits), key=lambda f: max(f, 1 / f))
        lines.append(f"- **{names}** ({counts}; ×{factor:.2f} at most). {sentences or UNKNOWN}")
    return "\n".join(lines)


def fits_off(found, angles):
    """(model, loss, factor) of the fits to a file whose light is off at one of the first angles."""
    return [
        (model, loss, farthest(found, fit))
        for model, by_loss in found["fits"].items()
        for loss, fit in by_loss.items()
        if is_beyond(found, fit, angles)
    ]


def flat(files):
    """How the light of the model without a Fresnel term is at 75°, in a sentence."""
    fits = [(found, fit) for found in files.values() for fit in found["fits"][FLAT].values()]
    off = [f for f, fit in fits if is_beyond(f, fit) and not is_beyond(f, fit, angles=2)]
    rise = median(found["albedo"][2] / found["albedo"][0] for found in off) if off else 1.0
    return (
        f"- **`{FLAT}`**, on any file ({len(off)} of its {len(fits)} fits). It has no Fresnel "
        "term, so that its albedo hardly depends on the angle; that of these files is at 75° "
        f"{rise:.2g} times that at 5°, in the median."
    )


def factors(found, fit, angles=3):
    """The albedos of a fit over those of its data, at the first `angles` that the data tell."""
    rows = zip(found["albedo"], found["known"], fit["albedo"], strict=True)
    return [own / its for its, known, own in list(rows)[:angles] if known]


def is_beyond(found, fit, angles=3):
    """Whether the light of a fit is off at one of the first `angles`."""
    return any(max(f, 1 / f) > OFF for f in factors(found, fit, angles))


def best(found):
    """(model, fit) of the best picture by the default loss."""
    fits = {model: by_loss[DEFAULT] for model, by_loss in found["fits"].items()}
    return max(fits.items(), key=lambda item: item[1]["psnr"])


def farthest(found, fit):
    """The factor by which the light of a fit is off, where it is farthest off."""
    return max(factors(found, fit), key=lambda f: max(f, 1 / f), default=1.0)


def _name(off):
    """The models whose light is off, with losses and factors."""
    models = {}
    for model, loss, factor in off:
        models.setdefault(model, []).append(f"`{loss}` ×{factor:.2f}")
    return ", ".join(f"`{model}` by {join_words(losses)}" for model, losses in models.items())


def why(found, off):
    """The sentences on a file, some of whose fits are `off`: what in its data the models lack."""
    sentences = [
        f"“{finding[0].upper()}{finding[1:].rstrip('.')}.”"
        for finding in found["findings"]
        if any(words in finding for words in TELLING)
    ]
    if found["negative"] > NEGATIVE:
        sentences.append(
            f"{percent(found['negative'])} of the values in linear sRGB are negative, of colours "
            "that sRGB does not hold; weights are not negative, so that fits are paler."
        )
    if (turn := _turn(found["hues"])) is not None:
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


def _turn(hues):
    """How the hue of a highlight changes, in words; None where it only becomes paler."""
    even = 1 / len(hues[0])
    for first, later in pairwise(hues):
        for channel, own, next_ in zip("RGB", first, later, strict=False):
            if abs(next_ - even) > abs(own - even) + SHIFT:
                return f"the share of {channel} goes from {percent(own)} to {percent(next_)}"
    return None


def where(found, model):
    """Where the log error of the best picture's fit comes from, in a sentence."""
    name, (share, factor) = max(found["regions"].items(), key=lambda item: item[1][0])
    size = max(factor, 1 / factor)
    how = f"{size:.2g} times too {'bright' if factor > 1 else 'dark'} in the mean"
    if size < EVEN:
        how = "too bright at some and too dark at others"
    return f"{percent(share)} of the squares are of {REGIONS[name]}; there `{model}` is {how}."


def percent(share, digits=0):
    """A share as text, with a space before the sign."""
    return f"{share:.{digits}%}".replace("%", " %")
