"""Writes the page of the leaderboard and its figure, from the scores of `make_leaderboard.py`."""

import platform
from collections import Counter, defaultdict
from pathlib import Path
from statistics import mean, median

from make_models import join_paragraphs, make_table

from brdfkit.core.version import find_versions
from brdfkit.theses.drawing import COLOURS, make_figure, style_axes

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
    """Write the page of the leaderboard and its figure.

    `scores`: `Score` of each fit; `seconds`: time of a fit by model; `full`: scores of fits to full
    tables; `restarts`: rows (material, model, loss of the fit, least loss of random starts);
    `facts`: values for the introduction, by name.
    """
    merl = facts["merl"]
    log = group_by_material([s for s in scores if (s.collection, s.loss) == (merl, "log")])
    facts = {**facts, "count": len(log), "versions": describe_versions()}
    text = join_paragraphs(
        *("# The leaderboard", INTRODUCTION.format(**facts)),
        *("## What was to be reached", BARS, make_bars_table(log)),
        *(
            "## All models on the reconstructions",
            ALL,
            make_models_table(log, scores, seconds, merl),
        ),
        *(
            "![How many materials each model shows within an error](leaderboard.png)",
            write_advice(log),
        ),
        make_measurements_section(scores, merl),
        *("## The best on each material", make_best_table(log)),
        make_checks_section(log, full, restarts),
    )
    PAGE.write_text(text, encoding="utf-8")
    draw_errors(log).savefig(PAGE.with_suffix(".png"), dpi=90)


def describe_versions():
    """Return a text with the versions of brdfkit, Python, and libraries that affect the numbers."""
    own, *others = (f"{name} {number}" for name, number in find_versions().items())
    return ", ".join([own, f"Python {platform.python_version()}", *others])


def group_by_material(scores):
    """Return the scores by material and model, of the materials that all models were fitted to."""
    found = defaultdict(dict)
    for score in scores:
        name = score.material
        found[name][score.model] = score
    most = max(map(len, found.values()), default=0)
    return {material: models for material, models in found.items() if len(models) == most}


def sort_models(log):
    """Return the names of the models, the one with the least median error first."""
    return sorted(next(iter(log.values()), ()), key=lambda model: compute_median_error(log, model))


def compute_median_error(log, model):
    return median(models[model].error for models in log.values())


def find_best_score(models, kind=lambda model: True):
    """Return the score of the best model on one material, among those for which `kind` is true."""
    return min((s for s in models.values() if kind(s.model)), key=lambda s: s.error)


def is_single(model):
    return "+" not in model


def is_sum(model):
    return not is_single(model)


BARS = """The bars were set before these fits were made, from trials on 20 of the materials."""


def make_bars_table(log):
    """Return the table of the errors that were to be reached, and the errors that are."""
    bars = (
        ("one GGX over Lambert", 0.171, compute_median_error(log, "ggx")),
        (
            "the best single model of each",
            0.140,
            median(find_best_score(m, is_single).error for m in log.values()),
        ),
        ("two GGX lobes", 0.113, compute_median_error(log, "ggx+ggx")),
        (
            "the best sum of each",
            0.090,
            median(find_best_score(m, is_sum).error for m in log.values()),
        ),
    )
    rows = [
        (what, f"≤ {bar:.3f}", f"{found:.4f}", "**reached**" if found <= bar else "**not reached**")
        for what, bar, found in bars
    ]
    return make_table(f"median ε of {len(log)} materials, to reach, reached, ", rows)


ALL = """Fits by the log loss; a sum has the ground of its first model. *best on*: on how many
materials a model has the least error; *time*: processor time of a fit of gold-metallic-paint over
that of one GGX; *by cosine*, *by cbrt*: the median ε of fits by those losses, to which bright
directions count."""


def make_models_table(log, scores, seconds, merl):
    """Return the table of all models, sorted by their median error."""
    wins = Counter(find_best_score(models).model for models in log.values())
    others = {
        loss: group_by_material([s for s in scores if (s.collection, s.loss) == (merl, loss)])
        for loss in ("cosine", "cbrt")
    }
    rows = []
    for model in sort_models(log):
        errors = [models[model].error for models in log.values()]
        parameters = next(iter(log.values()))[model].parameters
        by_others = [
            f"{compute_median_error(found, model):.4f}" if model in sort_models(found) else ""
            for found in others.values()
        ]
        row = f"`{model}`", parameters, f"{median(errors):.4f}", f"{mean(errors):.4f}"
        rows.append((*row, wins[model] or "", f"{seconds[model] / seconds['ggx']:.1f}", *by_others))
    return make_table(
        "model, parameters, median ε, mean ε, best on, time, by cosine, by cbrt", rows
    )


def write_advice(log):
    """Return sentences that recommend models, with numbers."""
    least = next(model for model in sort_models(log) if is_sum(model) and ":" not in model)
    near = sum(
        find_best_score(m, is_single).error <= 1.05 * find_best_score(m, is_sum).error
        for m in log.values()
    )
    lines = [
        f"- **One lobe or two.** On {near} of {len(log)} materials the best single model is within "
        "5 % of the best sum.",
        f"- **The sum to take**, before others: `{least}`. Beside `ggx+ggx`: "
        f"{compare_models(log, least, 'ggx+ggx')}.",
        f"- **The single model to take**: `{next(filter(is_single, sort_models(log)))}`. "
        "`student_t`, "
        f"which can be anisotropic, beside `ggx`: {compare_models(log, 'student_t', 'ggx')}.",
    ]
    for model in sort_models(log):
        plain, (ground, _, others) = model.replace(":fresnel=coloured", ""), model.partition("+")
        if plain != model and plain in sort_models(log):
            says = compare_models(log, model, plain)
            lines.append(f"- **A coloured Fresnel term**: beside `{plain}`: {says}.")
        if others in sort_models(log) and "+" in others:
            says = compare_models(log, model, others)
            lines.append(f"- **Another ground**, `{ground}`: beside `{others}`: {says}.")
    return "\n".join(lines)


def compare_models(log, model, other):
    """Return in words how the errors of a model compare with those of another one."""
    ratios = [models[model].error / models[other].error for models in log.values()]
    lower = sum(ratio < 1 for ratio in ratios)
    any_ = next(iter(log.values()))
    more = any_[model].parameters - any_[other].parameters
    return (
        f"ε changes by {median(ratios) - 1:+.1%} in the median, from {min(ratios) - 1:+.0%} to "
        f"{max(ratios) - 1:+.0%}, and is lower on {lower} of {len(ratios)}, with {more} more "
        f"parameter{'s' * (more != 1)}"
    )


def make_measurements_section(scores, merl):
    """Return the section with the median errors on the other collections of measurements."""
    names = dict.fromkeys(s.collection for s in scores if s.collection != merl)
    found = {n: group_by_material([s for s in scores if s.collection == n]) for n in names}
    if not found:
        return ""
    heads = [f"{name} ({len(materials)})" for name, materials in found.items()]
    rows = [
        (f"`{model}`", *(format_median_error(materials, model) for materials in found.values()))
        for model in sort_models(next(iter(found.values())))
    ]
    text = "Median ε of fits by the log loss, and on how many materials it is below that of `ggx`."
    return join_paragraphs(
        "## On measurements", text, make_table(", ".join(["model", *heads]), rows)
    ).strip()


def format_median_error(materials, model):
    """Return a model's median error as text, and on how many materials it is below GGX's."""
    below = sum(models[model].error < models["ggx"].error for models in materials.values())
    return f"{compute_median_error(materials, model):.4f}" + (
        f" ({below})" if model != "ggx" else ""
    )


def make_best_table(log):
    """Return the table of the best single model and the best sum for every material."""
    rows = []
    for material, models in sorted(log.items()):
        one, sum_ = find_best_score(models, is_single), find_best_score(models, is_sum)
        ggx = models["ggx"].error
        cells = f"`{one.model}`", f"{one.error:.4f}", f"`{sum_.model}`", f"{sum_.error:.4f}"
        rows.append((material, f"{ggx:.4f}", *cells))
    return make_table("material, `ggx`, best single model, ε, best sum, ε", rows)


def make_checks_section(log, full, restarts):
    """Return the section on two checks: fits of full tables, and searches from random starts."""
    if not restarts:
        return ""
    sizes = [(s.material, f"`{s.model}`", log[s.material][s.model].error, s.error) for s in full]
    starts = [(material, f"`{model}`", *errors) for material, model, *errors in restarts]
    most = max(abs(here / there - 1) for *_, here, there in sizes)
    worst = max(found / least - 1 for *_, found, least in starts)
    return join_paragraphs(
        "## What was checked",
        "**Resolution.** The reconstructions are fitted as tables smaller than MERL's. Fits of "
        f"tables of MERL's size differ in ε by {most:.2%} at most; by more than 1 % where one of "
        "the two searches ended elsewhere.",
        make_differences_table("ε, ε of a full table", sizes),
        "**Random starts.** E of the log loss on coarse tables, beside the least E of 50 searches, "
        "each from one random point and on all samples to its end: the fits are at most "
        f"{max(worst, 0):.2%} above it.",
        make_differences_table("E, least E of random starts", starts),
    ).strip()


def make_differences_table(heads, rows):
    """Return the table of `rows` (material, model, error, other error) with their difference."""
    body = [(*names, f"{a:.6f}", f"{b:.6f}", f"{a / b - 1:+.3%}") for *names, a, b in rows]
    return make_table(f"material, model, {heads}, difference", body)


def draw_errors(log):
    """Return the figure that shows on how many materials some models stay within an error."""
    drawn = make_figure(7.2, 3.6)
    axes = drawn.subplots()
    some = [
        "lambert",
        "ggx",
        "student_t",
        "ggx+ggx",
        next(m for m in sort_models(log) if is_sum(m)),
    ]
    curves = {model: [m[model].error for m in log.values()] for model in dict.fromkeys(some)}
    curves["the best of each"] = [find_best_score(m).error for m in log.values()]
    for (name, errors), colour in zip(curves.items(), COLOURS, strict=False):
        axes.step(sorted(errors), range(1, len(errors) + 1), label=name, color=colour, where="post")
    axes.set_xscale("log")
    axes.set_xlabel("ε")
    style_axes(axes, "", "materials within ε")
    drawn.legend(loc="outside lower center", ncols=3, fontsize=8, frameon=False)
    return drawn
