"""Writes the verdict of a report: which fit to take, why, and how large its errors are."""

from collections.abc import Mapping, Sequence

from brdfkit.core.names import join_words
from brdfkit.fitting.ranking import Ranking
from brdfkit.materials.auditing import Audit
from brdfkit.reporting.pictures.picture_errors import PictureError
from brdfkit.reporting.verdict.fit_errors import FitErrors, format_factor
from brdfkit.reporting.verdict.picture_verdict import (
    describe_nearest_picture,
    describe_visibility,
    has_nearest_picture,
)

# The worst band of incidence is mentioned if log(worst factor) / log(typical factor) is larger
MARKED_RATIO = 1.5
# Another fit is mentioned as better by some loss if its error is smaller by more than this factor
AHEAD_RATIO = 1.01


def write_verdict(
    names: Sequence[str],
    errors: Sequence[FitErrors],
    picture_errors: Mapping[str, PictureError],
    loss: str,
    ranking: Ranking | None = None,
) -> tuple[str, list[str]]:
    """Return the sentences at the head of a report, and a list of further sentences.

    `names`, `errors`: names and errors of the fits, the recommended fit first; `picture_errors`:
    errors of their pictures by metric; `loss`: name of the loss that ranks them; `ranking`: the
    ranking of models from which the fit was chosen, if there was one.
    """
    taken = errors[0]
    leaders = {
        name: min(range(len(errors)), key=lambda k: errors[k].by_loss[name])
        for name in taken.by_loss
    }
    alone = len(names) == 1
    if alone:
        why = f"was {_explain_choice(ranking)}" if ranking else "is the only fit"
    elif leaders[loss]:
        why = _explain_tie(names[leaders[loss]], errors[leaders[loss]], taken)
    else:
        why = _explain_lead(loss, leaders, has_nearest_picture(picture_errors["psnr"]))
    head = (
        f"{names[0]} {why}. Half of the measured values are met within a factor of "
        f"{format_factor(taken.typical_factor)}, 95\xa0% within "
        f"{format_factor(taken.large_factor)}, and {describe_visibility(picture_errors)}."
    )
    more = [] if alone else _describe_other_fits(names, errors, leaders, loss)
    if ranking and not alone:
        more.append(f"{ranking.best} was {_explain_choice(ranking)}.")
    more += describe_nearest_picture(names, picture_errors["psnr"])
    if taken.worst_factor > taken.typical_factor**MARKED_RATIO:
        low, high = taken.worst_band
        more.append(
            f"{names[0]} is farthest off at θi {low:g}° to {high:g}°: half of the values there are "
            f"met within a factor of {format_factor(taken.worst_factor)}."
        )
    return head, more


def describe_completion(audited: Audit) -> list[str]:
    """Return a sentence if the material is a completed table, otherwise an empty list."""
    rows = audited.rows()
    if "evidence" not in rows:
        return []
    return [
        "The material was completed from few values, and its completed table is what is called "
        f"measured here ({rows['evidence']} of the pairs of directions)."
    ]


def _explain_choice(ranking: Ranking) -> str:
    """Return a part of a sentence on why a ranking recommends its model."""
    count = sum(not row.message for row in ranking.rows)
    return f"chosen from {count} models, because {ranking.why}"


def _explain_tie(name: str, best: FitErrors, taken: FitErrors) -> str:
    """Return a part of a sentence for a recommended fit that is tied with the best one.

    `name`, `best`: name and errors of the best fit, which has more parameters; `taken`: errors of
    the recommended fit.
    """
    more = best.numbers - taken.numbers
    numbers = f"{more} more number{'s' * (more > 1)}"
    return f"is enough: {name}, with {numbers}, is no better by more than noise"


def _explain_lead(loss: str, leaders: Mapping[str, int], in_picture: bool) -> str:
    """Return a part of a sentence that names the losses by which the first fit is best.

    `loss`: the loss that ranks the fits; `leaders`: the index of the best fit by each loss;
    `in_picture`: whether the first fit has the nearest picture, too.
    """
    others = [name for name, index in leaders.items() if index == 0 and name != loss]
    by = f"by the loss{'es' * bool(others)} {join_words([loss, *others])}"
    if len(others) + 1 == len(leaders):
        by = "by every loss"
    return f"is best {by}" + " and by its picture" * in_picture


def _describe_other_fits(
    names: Sequence[str], errors: Sequence[FitErrors], leaders: Mapping[str, int], loss: str
) -> list[str]:
    """Return sentences on fits that are tied with the first, or better by other losses."""
    mentioned = leaders[loss]  # index of the fit that the sentence at the head mentions
    others = [k for k in range(1, len(names)) if k != mentioned]
    tied = [names[k] for k in others if errors[k].is_tied]
    verb = "is" if len(tied) == 1 else "are"
    sentences = []
    if tied:
        sentences.append(
            f"{join_words(tied)} {verb} not distinguishable from it by the loss {loss}."
        )
    ahead: dict[str, list[str]] = {}
    for other, index in leaders.items():
        own, least = errors[0].by_loss[other], errors[index].by_loss[other]
        if other != loss and own > AHEAD_RATIO * least:
            ahead.setdefault(names[index], []).append(other)
    sentences += [f"By {join_words(by)}, {name} is ahead." for name, by in ahead.items()]
    return sentences if sentences or mentioned else ["Its lead over the others is more than noise."]
