"""Writes the part of the page of real measurements on one material in five kinds of files."""

from collections import Counter
from statistics import median

from make_models import make_table
from real_measurements.invariance import CAUSES, OF_ALL, SAME, SAME_ALBEDO, find_cause
from real_measurements.reasons import format_percent

DEFAULT = "cbrt"
TEXT = f"""Does the fit depend on the file? Materials that are known everywhere, brdfkit's isotropic
tables and neural reconstructions of MERL's [Sztrajman et al. 2021], are written by brdfkit's own
writers, read again and fitted:

- a MERL table of 90×45×90 cells, to whose fits all others are held;
- an RGL grid of 64 incidences with 112×112 points each;
- a goniometer's grid, `.astm`: θ_i every 2.5° and θ_o every 1.25° below 80°, and 72 azimuths that
  close in on the mirror direction;
- 60,000 of the table's cells in no order, `.astm`;
- 20,000 rows, `.csv`, at random in the half and difference angles.

*Parameters* are those of shape, and the albedos of every lobe at 5° and at 75°, which stand for its
weight and its Fresnel parameter: these trade off. A parameter is the same within {SAME:.0%}, a
lobe's albedo also within {OF_ALL:.0%} of all light; an albedo of the whole, at 5°, 45° and 75°,
within {SAME_ALBEDO:.0%}.""".replace("%", " %")
CAUSED = """A fit with a parameter or an albedo that is not the same is tried further: its error on
the table, the error of the table's fit on the file, and fits of directions below 70°. The first of
these that applies:"""


def iterate_comparisons(materials):
    """Yield (material, model, loss, kind of file, results) for all comparisons."""
    for material, models in materials.items():
        for model, losses in models.items():
            for loss, kinds in losses.items():
                for kind, row in kinds.items():
                    yield material, model, loss, kind, row


def compute_same_shares(rows):
    """Return the shares of parameters and albedos that are equal in two fits, as texts."""
    found = [row["beside"] for row in rows]
    parameters = sum(same for _, same, *_ in found) / sum(count for count, *_ in found)
    albedos = [abs(f - 1) <= SAME_ALBEDO for _, _, _, _, *factors in found for f in factors]
    return [format_percent(share) for share in (parameters, sum(albedos) / len(albedos))]


def make_sameness_table(materials):
    """Return the table of shares of equal parameters and albedos, with a column for each file."""
    found = {}
    for _, model, loss, kind, row in iterate_comparisons(materials):
        found.setdefault((model, loss), {}).setdefault(kind, []).append(row)
    kinds = list(next(iter(found.values())))
    rows = [
        (
            f"`{model}`",
            f"`{loss}`",
            *("; ".join(compute_same_shares(by_kind[kind])) for kind in kinds),
        )
        for (model, loss), by_kind in found.items()
    ]
    head = make_table(", ".join(["model", "loss", *kinds]), rows)
    return f"Parameters that are the same; and albedos; of {len(materials)} materials:\n\n{head}"


def make_coverage_table(materials):
    """Return the table of unrepresented directions and effective samples, by kind of file."""
    found = {}
    for *_, loss, kind, row in iterate_comparisons(materials):
        if loss == DEFAULT:
            found.setdefault(kind, []).append(row)
    shares = [
        format_percent(max(row["unrepresented"] for row in rows), 1) for rows in found.values()
    ]
    counts = [f"{median(row['effective'] for row in rows):,.0f}" for rows in found.values()]
    rows = (
        ("`unrepresented`, at most", *shares),
        ("`effective_samples`, in the median", *counts),
    )
    return make_table(", ".join([f"by `{DEFAULT}`", *found]), rows)


def make_causes_table(materials):
    """Return the table of how often fits differ for each cause, by kind of file."""
    found = {}
    for *_, kind, row in iterate_comparisons(materials):
        found.setdefault(kind, Counter())[find_cause(row)] += 1
    total = {key: sum(counts[key] for counts in found.values()) for key in CAUSES}
    rows = [
        (meaning, *(counts[key] or "" for counts in found.values()), total[key])
        for key, meaning in CAUSES.items()
        if total[key]
    ]
    rows.append(
        (
            "fits in all",
            *(sum(c.values()) for c in found.values()),
            len(list(iterate_comparisons(materials))),
        )
    )
    return f"{CAUSED}\n\n" + make_table(", ".join(["cause", *found, "all"]), rows)


def list_open_cases(materials):
    """Return a list of the fits that differ without a known cause."""
    lines = [
        f"- {material}, `{model}` by `{loss}`, {kind}: "
        f"{row['beside'][2].replace('_', ' ')} {row['beside'][3]:+.0%}, the error on the table "
        f"{row['excess']:+.1%}.".replace("%", " %")
        for material, model, loss, kind, row in iterate_comparisons(materials)
        if find_cause(row) == "open"
    ]
    return "What is left without a cause:\n\n" + "\n".join(lines) if lines else ""


def write_verdict(materials):
    """Return sentences that sum up the comparisons, with numbers."""
    rows = list(iterate_comparisons(materials))
    every = compute_same_shares([row for *_, row in rows])
    own = compute_same_shares([row for *_, loss, _, row in rows if loss == DEFAULT])
    found = Counter(find_cause(row) for *_, row in rows)
    return [
        f"- **One material, five files.** By the default loss {own[0]} of the parameters and "
        f"{own[1]} of the albedos are those of the fit to the MERL table, by all losses {every[0]} "
        f"and {every[1]}.",
        f"- **What differs.** {len(rows) - found[None]} of {len(rows)} fits differ in a parameter "
        f"or an albedo: {found['flat']} of them in nothing that the loss can tell, and "
        f"{found['open']} without a cause that was found.",
    ]
