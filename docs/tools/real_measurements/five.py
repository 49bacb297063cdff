"""The part of the page of real measurements on one material as five files."""

from collections import Counter
from statistics import median

from make_models import table
from real_measurements.invariance import CAUSES, OF_ALL, SAME, SAME_ALBEDO, cause
from real_measurements.reasons import percent

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


def rows_of(materials):
    """Yield (material, model, loss, kind of file, row) of all comparisons."""
    for material, models in materials.items():
        for model, losses in models.items():
            for loss, kinds in losses.items():
                for kind, row in kinds.items():
                    yield material, model, loss, kind, row


def shares(rows):
    """The shares of parameters and of albedos that are the same, as texts."""
    found = [row["beside"] for row in rows]
    parameters = sum(same for _, same, *_ in found) / sum(count for count, *_ in found)
    albedos = [abs(f - 1) <= SAME_ALBEDO for _, _, _, _, *factors in found for f in factors]
    return [percent(share) for share in (parameters, sum(albedos) / len(albedos))]


def sameness(materials):
    """How many parameters and albedos are the same, by model and loss, for each kind of file."""
    found = {}
    for _, model, loss, kind, row in rows_of(materials):
        found.setdefault((model, loss), {}).setdefault(kind, []).append(row)
    kinds = list(next(iter(found.values())))
    rows = [
        (f"`{model}`", f"`{loss}`", *("; ".join(shares(by_kind[kind])) for kind in kinds))
        for (model, loss), by_kind in found.items()
    ]
    head = table(", ".join(["model", "loss", *kinds]), rows)
    return f"Parameters that are the same; and albedos; of {len(materials)} materials:\n\n{head}"


def unrepresented(materials):
    """What no sample stands for, and how many samples would tell as much, by kind of file."""
    found = {}
    for *_, loss, kind, row in rows_of(materials):
        if loss == DEFAULT:
            found.setdefault(kind, []).append(row)
    shares = [percent(max(row["unrepresented"] for row in rows), 1) for rows in found.values()]
    counts = [f"{median(row['effective'] for row in rows):,.0f}" for rows in found.values()]
    rows = (
        ("`unrepresented`, at most", *shares),
        ("`effective_samples`, in the median", *counts),
    )
    return table(", ".join([f"by `{DEFAULT}`", *found]), rows)


def causes(materials):
    """How often fits differ by each cause, for each kind of file."""
    found = {}
    for *_, kind, row in rows_of(materials):
        found.setdefault(kind, Counter())[cause(row)] += 1
    total = {key: sum(counts[key] for counts in found.values()) for key in CAUSES}
    rows = [
        (meaning, *(counts[key] or "" for counts in found.values()), total[key])
        for key, meaning in CAUSES.items()
        if total[key]
    ]
    rows.append(
        ("fits in all", *(sum(c.values()) for c in found.values()), len(list(rows_of(materials))))
    )
    return f"{CAUSED}\n\n" + table(", ".join(["cause", *found, "all"]), rows)


def open_cases(materials):
    """The fits that differ by no cause that was found."""
    lines = [
        f"- {material}, `{model}` by `{loss}`, {kind}: "
        f"{row['beside'][2].replace('_', ' ')} {row['beside'][3]:+.0%}, the error on the table "
        f"{row['excess']:+.1%}.".replace("%", " %")
        for material, model, loss, kind, row in rows_of(materials)
        if cause(row) == "open"
    ]
    return "What is left without a cause:\n\n" + "\n".join(lines) if lines else ""


def verdict(materials):
    """What came out, in lines with figures."""
    rows = list(rows_of(materials))
    every = shares([row for *_, row in rows])
    own = shares([row for *_, loss, _, row in rows if loss == DEFAULT])
    found = Counter(cause(row) for *_, row in rows)
    return [
        f"- **One material, five files.** By the default loss {own[0]} of the parameters and "
        f"{own[1]} of the albedos are those of the fit to the MERL table, by all losses {every[0]} "
        f"and {every[1]}.",
        f"- **What differs.** {len(rows) - found[None]} of {len(rows)} fits differ in a parameter "
        f"or an albedo: {found['flat']} of them in nothing that the loss can tell, and "
        f"{found['open']} without a cause that was found.",
    ]
