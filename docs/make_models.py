"""Makes the pages and pictures of `docs/models/` from the models' files: nothing is written twice.

    python docs/make_models.py              # pages, balls and lobes, two minutes
    python docs/make_models.py ward ggx     # the pictures of these, and all pages
    python docs/make_models.py --check      # exit 1 where a page is not what its model says

A form with parameters of its own has another table and begins at other values; one that has the
same parameters is shown beside the default.
"""

import argparse
import inspect
import io
import math
import sys
from pathlib import Path

import brdfkit as bk
from brdfkit import records, registry

FOLDER = Path(__file__).with_name("models")
SIZE, SPP, COLOURS = 320, 128, 192
ANGLES = (15, 45, 75)  # degrees of incidence
RGB = (1.0, 0.8, 0.6)  # the example's colour, times the default


def models():
    """brdfkit's own models by name, without a user's that were loaded."""
    ours = "brdfkit.plugins."
    return {name: m for name, m in bk.models().items() if m.__module__.startswith(ours)}


def pages():
    """File name → text of every page, the index among them."""
    return {"README.md": index()} | {f"{name}.md": page(m) for name, m in models().items()}


def index():
    """All models with a sentence, their options and a ball."""
    rows = [
        [f"[{name}]({name}.md)", sentence(model), options_in_short(model), ball(model, 160)]
        for name, model in models().items()
    ]
    return joined(
        "# The models",
        "One file in [`plugins/bsdfs/`](../../plugins/bsdfs) is one model; `docs/make_models.py` "
        "made these pages from them. The balls show the defaults: weights, exposure and light are "
        "equal for none but the light. `brdfkit models NAME` prints a page on the command line.",
        table(["model", "what it is", "options", ""], rows),
    )


def page(model):
    """Everything about one model."""
    name, (title, _, _), text = model.type_name(), *docstring(model)
    shown = forms(model)
    labels = ", ".join(f"`{form.label()}`" for form in shown)
    return joined(
        f"# {title}",
        sentence(model),
        table([f"`{form.label()}`" for form in shown], [[ball(form, SIZE) for form in shown]]),
        text,
        "## Parameters",
        table(["parameter", "default", "bounds", "meaning", "per channel"], parameters(model)),
        options(model),
        "## Its lobes",
        f"![Lobes of {name}]({name}_lobes.png)",
        f"In the plane of incidence, at the defaults: {labels}.",
        usage(model),
        f"The source: [`{name}.py`](../../plugins/bsdfs/{name}.py). [All models](README.md)",
    )


def docstring(model):
    """(title, ": ", sentence) and the other lines of the model's page."""
    head, _, text = inspect.getdoc(sys.modules[model.__module__]).partition("\n")
    return head.partition(": "), text.strip("\n")


def sentence(model):
    """What the model is, from the first line of its file."""
    text = docstring(model)[0][2]
    return text[0].upper() + text[1:]


def forms(model):
    """The model, and it with each other word of an option that leaves the parameters the same."""
    words = [(n, w) for n, o in model.options.items() for w in o.choices or () if w != o.default]
    others = [model.configured(**{name: w}) for name, w in words if isinstance(w, str)]
    return [model, *(other for other in others if other.parameters == model.parameters)]


def picture(form):
    """File name of the ball of a form."""
    return "_".join([form.type_name(), *(f"{n}_{v}" for n, v in form.chosen().items())]) + ".png"


def ball(form, width):
    return f'<img src="{picture(form)}" width="{width}" alt="A ball of {form.label()}">'


def parameters(model):
    """The rows of the table of parameters."""
    for name, p in model.parameters.items():
        default = f"as `{p.follows}`" if p.follows else f"{p.default:g}"
        bounds = "{} to {}".format(*map(bound, p.bounds))
        yield [f"`{name}`", default, bounds, p.meaning, "yes" if p.linear else ""]


def bound(value):
    sign = "−" if value < 0 else ""
    return sign + ("∞" if math.isinf(value) else f"{abs(value):.4g}")


def options(model):
    """The table of options, nothing where there are none."""
    rows = [
        [f"`{name}`", str(o.default), records.choices(o), o.meaning]
        for name, o in model.options.items()
    ]
    head = ["option", "default", "choices", "meaning"]
    return joined("## Options", table(head, rows)) if rows else ""


def options_in_short(model):
    return "<br>".join(f"`{n}`: {records.choices(o)}" for n, o in model.options.items())


def example(model):
    """(options, values) by name that show how they are written: one of each kind."""
    chosen = {}
    for name in list(model.options)[:1]:
        model = registry.model(records.example(model, name))
        chosen[name] = getattr(model, name)
    values = {n: [round(c * model.parameters[n].default, 4) for c in RGB] for n in model.weights()[:1]}
    return chosen, values | {n: model.parameters[n].default for n in model.shapes()[:1]}
