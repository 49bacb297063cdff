"""The page and the figure of the leaderboard: the scores of `make_leaderboard.py`, in words."""

import platform
from collections import Counter, defaultdict
from pathlib import Path
from statistics import mean, median

from make_models import paragraphs, table

from brdfkit.core.version import find_versions
from brdfkit.theses.drawing import COLOURS, figure, tidy

PAGE = Path(__file__).parents[2] / "leaderboard.md"
INTRODUCTION = """Every model, fitted to every measurement at hand, and how far it is off. Made by
`BRDFKIT_DATA=FOLDER python docs/tools/make_leaderboard.py --cache CACHE`, which goes on from where
it was stopped; FOLDER holds third-party files, which brdfkit does not ship.

The error ε is the RMS over R, G and B of ln((f cosθ_i cosθ_o + 0.001) / (g cosθ_i cosθ_o + 0.001)):
0.1 is about 10 %. f is the fit and g the truth, at {pairs:,} direction pairs, uniform in
half/difference angles and below {angle:g}°. They are evaluated here by NumPy, apart from any fit.

- *{count} reconstructions* stand for MERL's tables, which are not at hand: neural networks, smooth
  and without noise [Sztrajman et al. 2021]. The truth is the network; tables of {shape} cells of it
  are fitted.
- *Paints* [Mini-Diff] and *Cornell* are goniometer data. Nothing is known between their samples, so
  ε is that of the samples that were fitted.
- *RGL*'s files are asked by their own lookup, also where it has few samples, as where both
  directions graze.

An option belongs to the model before it: of `abc+student_t:fresnel=coloured`, to `student_t`.

{versions}; seed {seed}."""


def write_page(scores, seconds, full, restarts, facts):
    """Write the page of all `scores`, the `seconds` of a fit by model, the scores of the `full`
    tables, and the `restarts`, (material, model, E of the fit, least E of random starts); `facts`:
    what the introduction tells."""
    merl = facts["merl"]
    log = by_material([s for s in scores if (s.collection, s.loss) == (merl, "log")])
    facts = {**facts, "count": len(log), "versions": made_with()}
    text = paragraphs(
        *("# The leaderboard", INTRODUCTION.format(**facts)),
        *("## What was to be reached", BARS, reached(log)),
        *("## All models on the reconstructions", ALL, all_models(log, scores, seconds, merl)),
        *("![How many materials each model shows within an error](leaderboard.png)", advice(log)),
        measurements(scores, merl),
        *("## The best on each material", best_of_each(log)),
        checked(log, full, restarts),
    )
    PAGE.write_text(text, encoding="utf-8")
    draw(log).savefig(PAGE.with_suffix(".png"), dpi=90)


def made_with():
    """The versions of brdfkit, of Python and of what the numbers depend on, in words."""
    own, *others = (f"{name} {number}" for name, number in find_versions().items())
    return ", ".join([own, f"Python {platform.python_version()}", *others])


def by_material(scores):
    """Material → model → `Score`; of materials that all models were fitted to."""
    found = defaultdict(dict)
    for score in scores:
        name = score.material
        found[name][score.model] = score
    most = max(map(len, found.values()), default=0)
    return {material: models for material, models in found.items() if len(models) == most}


def models_of(log):
    """The models, the least median error first."""
    return sorted(next(iter(log.values()), ()), key=lambda model: median_of(log, model))


def median_of(log, model):
    return median(models[model].error for models in log.values())


def best(models, kind=lambda model: True):
    """The score of the best of the models of a `kind` on one material."""
    return min((s for s in models.values() if kind(s.model)), key=lambda s: s.error)


def single(model):
    return "+" not in model


def composed(model):
    return not single(model)


BARS = """The bars were set before these fits were made, from trials on 20 of the materials."""


def reached(log):
    """The bars, and what is reached, as a table."""
    bars = (
        ("one GGX over Lambert", 0.171, median_of(log, "ggx")),
        (
            "the best single model of each",
            0.140,
            median(best(m, single).error for m in log.values()),
        ),
        ("two GGX lobes", 0.113, median_of(log, "ggx+ggx")),
        ("the best sum of each", 0.090, median(best(m, composed).error for m in log.values())),
    )
    rows = [
        (what, f"≤ {bar:.3f}", f"{found:.4f}", "**reached**" if found <= bar else "**not reached**")
        for what, bar, found in bars
    ]
    return table(f"median ε of {len(log)} materials, to reach, reached, ", rows)


ALL = """Fits by the log loss; a sum has the ground of its first model. *best on*: on how many
materials a model has the least error; *time*: processor time of a fit of gold-metallic-paint over
that of one GGX; *by cosine*, *by cbrt*: the median ε of fits by those losses, to which bright
directions count."""


def all_models(log, scores, seconds, merl):
    """The models by their median error, with those of other losses."""
    wins = Counter(best(models).model for models in log.values())
    others = {
        loss: by_material([s for s in scores if (s.collection, s.loss) == (merl, loss)])
        for loss in ("cosine", "cbrt")
    }
    rows = []
    for model in models_of(log):
        errors = [models[model].error for models in log.values()]
        parameters = next(iter(log.values()))[model].parameters
        by_others = [
            f"{median_of(found, model):.4f}" if model in models_of(found) else ""
            for found in others.values()
        ]
        row = f"`{model}`", parameters, f"{median(errors):.4f}", f"{mean(errors):.4f}"
        rows.append((*row, wins[model] or "", f"{seconds[model] / seconds['ggx']:.1f}", *by_others))
    return table("model, parameters, median ε, mean ε, best on, time, by cosine, by cbrt", rows)


def advice(log):
    """What to take from the table, in words, with its figures."""
    least = next(model for model in models_of(log) if composed(model) and ":" not in model)
    near = sum(best(m, single).error <= 1.05 * best(m, composed).error for m in log.values())
    lines = [
        f"- **One lobe or two.** On {near} of {len(log)} materials the best single model is within "
        "5 % of the best sum.",
        f"- **The sum to take**, before others: `{least}`. Beside `ggx+ggx`: "
        f"{beside(log, least, 'ggx+ggx')}.",
        f"- **The single model to take**: `{next(filter(single, models_of(log)))}`. `student_t`, "
        f"which can be anisotropic, beside `ggx`: {beside(log, 'student_t', 'ggx')}.",
    ]
    for model in models_of(log):
        plain, (ground, _, others) = model.replace(":fresnel=coloured", ""), model.partition("+")
        if plain != model and plain in models_of(log):
            says = beside(log, model, plain)
            lines.append(f"- **A coloured Fresnel term**: beside `{plain}`: {says}.")
        if others in models_of(log) and "+" in others:
            says = beside(log, model, others)
            lines.append(f"- **Another ground**, `{ground}`: beside `{others}`: {says}.")
    return "\n".join(lines)


def beside(log, model, other):
    """How one model does beside another, in words."""
    ratios = [models[model].error / models[other].error for models in log.values()]
    lower = sum(ratio < 1 for ratio in ratios)
    any_ = next(iter(log.values()))
    more = any_[model].parameters - any_[other].parameters
    return (
        f"ε changes by {median(ratios) - 1:+.1%} in the median, from {min(ratios) - 1:+.0%} to "
        f"{max(ratios) - 1:+.0%}, and is lower on {lower} of {len(ratios)}, with {more} more "
        f"parameter{'s' * (more != 1)}"
    )


def measurements(scores, merl):
    """The median errors on each other collection of measurements."""
    names = dict.fromkeys(s.collection for s in scores if s.collection != merl)
    found = {n: by_material([s for s in scores if s.collection == n]) for n in names}
    if not found:
        return ""
    heads = [f"{name} ({len(materials)})" for name, materials in found.items()]
    rows = [
        (f"`{model}`", *(beside_ggx(materials, model) for materials in found.values()))
        for model in models_of(next(iter(found.values())))
    ]
    text = "Median ε of fits by the log loss, and on how many materials it is below that of `ggx`."
    return paragraphs("## On measurements", text, table(", ".join(["model", *heads]), rows)).strip()


def beside_ggx(materials, model):
    """The median error of a model, and how often it is below GGX's."""
    below = sum(models[model].error < models["ggx"].error for models in materials.values())
    return f"{median_of(materials, model):.4f}" + (f" ({below})" if model != "ggx" else "")


def best_of_each(log):
    """The best model and the best sum of every material."""
    rows = []
    for material, models in sorted(log.items()):
        one, sum_ = best(models, single), best(models, composed)
        ggx = models["ggx"].error
        cells = f"`{one.model}`", f"{one.error:.4f}", f"`{sum_.model}`", f"{sum_.error:.4f}"
        rows.append((material, f"{ggx:.4f}", *cells))
    return table("material, `ggx`, best single model, ε, best sum, ε", rows)


def checked(log, full, restarts):
    """What a full table changes, and what random starts find."""
    if not restarts:
        return ""
    sizes = [(s.material, f"`{s.model}`", log[s.material][s.model].error, s.error) for s in full]
    starts = [(material, f"`{model}`", *errors) for material, model, *errors in restarts]
    most = max(abs(here / there - 1) for *_, here, there in sizes)
    worst = max(found / least - 1 for *_, found, least in starts)
    return paragraphs(
        "## What was checked",
        "**Resolution.** The reconstructions are fitted as tables smaller than MERL's. Fits of "
        f"tables of MERL's size differ in ε by {most:.2%} at most; by more than 1 % where one of "
        "the two searches ended elsewhere.",
        differences("ε, ε of a full table", sizes),
        "**Random starts.** E of the log loss on coarse tables, beside the least E of 50 searches, "
        "each from one random point and on all samples to its end: the fits are at most "
        f"{max(worst, 0):.2%} above it.",
        differences("E, least E of random starts", starts),
    ).strip()


def differences(heads, rows):
    """Rows (material, model, error, another error) with their relative difference."""
    body = [(*names, f"{a:.6f}", f"{b:.6f}", f"{a / b - 1:+.3%}") for *names, a, b in rows]
    return table(f"material, model, {heads}, difference", body)


def draw(log):
    """The figure: on how many materials each of some models is within an error."""
    drawn = figure(7.2, 3.6)
    axes = drawn.subplots()
    some = [
        "lambert",
        "ggx",
        "student_t",
        "ggx+ggx",
        next(m for m in models_of(log) if composed(m)),
    ]
    curves = {model: [m[model].error for m in log.values()] for model in dict.fromkeys(some)}
    curves["the best of each"] = [best(m).error for m in log.values()]
    for (name, errors), colour in zip(curves.items(), COLOURS, strict=False):
        axes.step(sorted(errors), range(1, len(errors) + 1), label=name, color=colour, where="post")
    axes.set_xscale("log")
    axes.set_xlabel("ε")
    tidy(axes, "", "materials within ε")
    drawn.legend(loc="outside lower center", ncols=3, fontsize=8, frameon=False)
    return drawn
