"""The verdict of a report in words: which fit to take, why, and how far off it is."""

from brdfkit.core.names import join_words
from brdfkit.reporting.verdict.picture_verdict import (
    leads_in_picture,
    nearer_in_picture,
    visibility,
)

MARKED = 1.5  # times the typical logarithm: so much worse is worth a sentence
AHEAD = 1.01  # times another fit's error: less is not worth a sentence
MOST = 1000  # a larger factor says no more than that the fit fails


def verdict(names, standings, errors, loss, ranking=None):
    """The sentences at the head, and a list of others below it.

    `names`: of the fits; `standings`: theirs; both in their order, the one to take first. `errors`:
    their `PictureError`s by metric, in the same order. `loss`: by which they are ranked. `ranking`:
    the `Ranking` that chose a model, or None.
    """
    taken = standings[0]
    firsts = {name: _first([one.errors[name] for one in standings]) for name in taken.errors}
    alone = len(names) == 1
    if alone:
        why = f"was {_chosen(ranking)}" if ranking else "is the only fit"
    elif firsts[loss]:
        why = _is_enough(names[firsts[loss]], standings[firsts[loss]], taken)
    else:
        why = _leads(loss, firsts, leads_in_picture(errors["psnr"]))
    head = (
        f"{names[0]} {why}. Half of the measured values are met within a factor of "
        f"{in_words(taken.typical)}, 95\xa0% within {in_words(taken.most)}, and "
        f"{visibility(errors)}."
    )
    more = [] if alone else _others(names, standings, firsts, loss)
    if ranking and not alone:
        more.append(f"{ranking.best} was {_chosen(ranking)}.")
    more += nearer_in_picture(names, errors["psnr"])
    if taken.worst > taken.typical**MARKED:
        low, high = taken.worst_at
        more.append(
            f"{names[0]} is farthest off at θi {low:g}° to {high:g}°: half of the values there are "
            f"met within a factor of {in_words(taken.worst)}."
        )
    return head, more


def in_words(factor):
    """A factor as text.

    >>> in_words(1.057), in_words(23.4)
    ('1.06', '23')
    """
    if factor >= MOST:
        return f"{MOST:,} or more"
    return f"{factor:.2f}" if factor < 10 else f"{factor:.0f}"


def _chosen(ranking):
    """Why the `ranking` recommends its model, in words."""
    count = sum(not row.message for row in ranking.rows)
    return f"chosen from {count} models, because {ranking.why}"


def _is_enough(name, best, taken):
    """That the fit to take is tied with the `best`, which has this name and more numbers."""
    more = best.numbers - taken.numbers
    numbers = f"{more} more number{'s' * (more > 1)}"
    return f"is enough: {name}, with {numbers}, is no better by more than noise"


def _leads(loss, firsts, in_picture):
    """What the best fit leads in, in words; `firsts`: the place of the best by each loss."""
    others = [name for name, place in firsts.items() if place == 0 and name != loss]
    by = f"by the loss{'es' * bool(others)} {join_words([loss, *others])}"
    if len(others) + 1 == len(firsts):
        by = "by every loss"
    return f"is best {by}" + " and by its picture" * in_picture


def _first(errors):
    """The place of the least error."""
    return errors.index(min(errors))


def _others(names, standings, firsts, loss):
    """Sentences on ties, and on other fits that lead by other losses."""
    told = firsts[loss]  # by the head
    rest = [k for k in range(1, len(names)) if k != told]
    tied = [names[k] for k in rest if standings[k].tied]
    verb = "is" if len(tied) == 1 else "are"
    said = (
        [f"{join_words(tied)} {verb} not distinguishable from it by the loss {loss}."]
        if tied
        else []
    )
    ahead: dict[str, list[str]] = {}
    for other, place in firsts.items():
        own, least = standings[0].errors[other], standings[place].errors[other]
        if other != loss and own > AHEAD * least:
            ahead.setdefault(names[place], []).append(other)
    said += [f"By {join_words(by)}, {name} is ahead." for name, by in ahead.items()]
    return said if said or told else ["Its lead over the others is more than noise."]
