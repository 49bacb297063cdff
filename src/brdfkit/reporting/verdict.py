"""The verdict of a report in words: which fit is best, by what, how far off it is, and whether one
can see it."""

# ΔE: the least difference that is seen side by side, and one that is plain
SEEN, PLAIN = 1.0, 3.0
NOISE = 0.5  # what is less than this part of the noise is not known


def verdict(names, standings, errors, loss):
    """The sentence at the head, and a list of others below it.

    `names`: of the fits; `standings`: theirs; both in the order of the `loss` by which they are
    ranked. `errors`: their `PictureError`s by metric, in the same order.
    """
    best, seen = standings[0], errors["psnr"]
    firsts = {name: _first([one.errors[name] for one in standings]) for name in best.errors}
    nearest = seen.first
    head = (
        f"{names[0]} {_leads(loss, firsts, nearest == 0, len(names))}: half of the measured values "
        f"are met within {in_words(best.typical)}, 95\xa0% within {in_words(best.most)}, and "
        f"{_visible(errors)}."
    )
    more = _others(names, standings, firsts) if len(names) > 1 else []
    if nearest:
        values = f"{seen.text(seen.values[nearest])}, against {seen.text(seen.values[0])}"
        more.append(
            f"In the picture {names[nearest]} comes nearest: {seen.title} {values} of {names[0]}."
        )
    low, high = best.worst_at
    more.append(
        f"{names[0]} is farthest off at θi {low:g}° to {high:g}°: half of the values there are met "
        f"within {in_words(best.worst)}."
    )
    return head, more


def in_words(factor):
    """A factor in words: in percent as long as it is small.

    >>> in_words(1.06), in_words(2.5)
    ('6.0\xa0%', 'a factor of 2.5')
    """
    percent = 100 * (factor - 1)
    if percent < 10:
        return f"{percent:.1f}\xa0%"
    return f"{percent:.0f}\xa0%" if percent < 50 else f"a factor of {factor:.2g}"


def _leads(loss, firsts, in_picture, count):
    """What the best fit leads in, in words; `firsts`: the place of the best by each loss."""
    if count == 1:
        return "is the only fit"
    others = [name for name, place in firsts.items() if place == 0 and name != loss]
    by = f"by the loss{'es' * bool(others)} {_list([loss, *others])}"
    if len(others) + 1 == len(firsts):
        by = "by every loss"
    return f"is best {by}" + " and by its picture" * in_picture


def _first(errors):
    """The place of the least error."""
    return errors.index(min(errors))


def _visible(errors):
    """Whether the first fit's picture can be told from the measured one, in words."""
    median, upper = errors["delta_e_2000"], errors["delta_e_2000_95"]
    typical, most = (_without_noise(error) for error in (median, upper))
    figures = f"ΔE {median.values[0]:.1f} in the median, where noise alone has {median.floor:.1f}"
    if most < NOISE * upper.floor:
        return f"its picture differs by no more than noise ({figures})"
    if most < SEEN:
        return f"its picture cannot be told from the measured one by eye ({figures})"
    if typical < SEEN:
        return f"its picture differs visibly in places only ({figures})"
    if typical < PLAIN:
        return f"its picture differs visibly, side by side ({figures})"
    return f"its picture is plainly another one ({figures})"


def _without_noise(error):
    """The first fit's error less that of noise, which adds to it as squares do."""
    return max(error.values[0] ** 2 - error.floor**2, 0.0) ** 0.5


def _others(names, standings, firsts):
    """Sentences on ties, and on other fits that lead by other losses."""
    tied = [name for name, one in zip(names[1:], standings[1:], strict=True) if one.tied]
    verb = "is" if len(tied) == 1 else "are"
    said = [f"{_list(tied)} {verb} not distinguishable from it by this loss."] if tied else []
    ahead: dict[str, list[str]] = {}
    for loss, place in firsts.items():
        if place:
            ahead.setdefault(names[place], []).append(loss)
    said += [f"By {_list(losses)}, {name} is ahead." for name, losses in ahead.items()]
    return said or ["Its lead over the others is more than noise."]


def _list(words):
    """Words as a list in a sentence."""
    *first, last = words
    return f"{', '.join(first)} and {last}" if first else last
