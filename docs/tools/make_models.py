"""Makes `docs/models/` of the models' files: a page each, with balls and lobes, and the index.

python docs/tools/make_models.py              # pages and pictures, in two minutes
python docs/tools/make_models.py --check      # exits 1 where a page is not what its model says
"""

import json
import sys
from pathlib import Path

import numpy as np
from formulas import set_formulas
from PIL import Image

import brdfkit as bk
from brdfkit.cli.commands.models import format_choices, make_example_label
from brdfkit.core.discovery.plugin_pages import read_page as plugin_page
from brdfkit.model import labels

FOLDER = Path(__file__).parents[1] / "models"
SIZE, SPP = 320, 128
INDEX = """A model is a file in [`plugins/bsdfs/`](../../plugins/bsdfs), of which
`docs/tools/make_models.py` makes its page here. The balls show what each is for, by the
values that its file names, all in the same light; lobes are those of the defaults. A
form of a model is named with its option, `koenderink:order=8`, a sum of models with a plus,
`oren_nayar+ward`: see [mixture](mixture.md). In Mitsuba every parameter may be a texture, and one
that is "per channel" takes a number or one per colour."""
EXPOSED = """In Mitsuba each parameter may be a texture. `mi.traverse` shows them, and gradients
flow to them."""
USE = """    {fits}

```python
import brdfkit as bk
import mitsuba as mi

measured = bk.load("car_paint")  # a file, or a material that brdfkit brings
fit = bk.fit(measured, "{label}")
bk.render([measured, fit]).write("fit.png")

mi.set_variant("llvm_ad_rgb")
material = {entries}
bsdf = mi.load_dict(material)
```

```xml
{xml}
```"""


def pages():
    """File name → text of all pages."""
    rows = []
    for name, model in models().items():
        options = "<br>".join(f"`{n}`: {format_choices(o)}" for n, o in model.options.items())
        rows.append((f"[{name}]({name}.md)", docstring(model)[1], options, ball(model, SIZE // 2)))
    index = paragraphs("# The models", INDEX, table("model, what it is, options, ball", rows))
    return {"README.md": index} | {f"{name}.md": page(m) for name, m in models().items()}


def models():
    """brdfkit's own models by name, without those of a user's that were loaded."""
    found = bk.models().items()
    return {name: m for name, m in found if m.__module__.startswith("brdfkit.plugins.")}


def page(model):
    """The text of a model's page."""
    name, (title, sentence, text), shown = model.type_name(), docstring(model), forms(model)
    balls = table(", ".join(f"`{f.label()}`" for f in shown), [[ball(f, SIZE) for f in shown]])
    values = ", ".join(f"`{n}` = {v}" for n, v in shown_values(model).items())
    parameters = [parameter(*item) for item in model.parameters.items()]
    options = [
        (f"`{n}`", o.default, format_choices(o), o.meaning) for n, o in model.options.items()
    ]
    return paragraphs(
        *(f"# {title}", sentence, balls, f"The ball has {values or 'the defaults'}.", text),
        table("parameter, default, bounds, meaning, per channel", parameters),
        EXPOSED,
        options and table("option, default, choices, meaning", options),
        f"![Polar plots of {name} in the plane of incidence]({name}_lobes.png)",
        *("## Use", use(model)),
        references(model),
        f"[The source](../../plugins/bsdfs/{name}.py) · [all models](README.md)",
    )


def paragraphs(*texts):
    return "\n\n".join(filter(None, texts)) + "\n"


def table(head, rows):
    lines = [head.split(", "), ["---"] * len(head.split(", ")), *rows]
    return "\n".join(
        "| " + " | ".join(str(c).replace("|", "∣") for c in line) + " |" for line in lines
    )


def docstring(source):
    """Title, sentence and the other lines of the page of a plugin's file or class."""
    found = plugin_page(source)
    text = set_formulas("\n".join(found.lines).strip("\n"))
    return found.title, found.sentence[0].upper() + found.sentence[1:], text


def references(source):
    """The works that a page cites, in full."""
    found = plugin_page(source).references
    return found and "## References\n\n" + "\n".join(f"- {work}" for work in found)


def parameter(name, p):
    default = f"`{p.follows}`" if p.follows else f"{p.default:.4g}"
    bounds = "{:g} to {:g}".format(*p.bounds).replace("-", "−").replace("inf", "∞")
    return f"`{name}`", default, bounds, p.meaning, "yes" if p.linear else ""


def forms(model):
    """The model, and it with each word of an option that leaves the parameters as they are."""
    words = [(n, w) for n, o in model.options.items() for w in o.choices or () if w != o.default]
    others = [model.configured(**{name: word}) for name, word in words if isinstance(word, str)]
    return [model, *(other for other in others if other.parameters == model.parameters)]


def ball(form, width):
    return f'<img src="{picture(form)}" width="{width}" alt="A ball of {form.label()}">'


def shown_values(form):
    """The values of a form's ball: those of `PICTURE` in its file, else the defaults."""
    chosen = getattr(sys.modules[form.__module__], "PICTURE", {})
    return {name: value for name, value in chosen.items() if name in form.parameters}


def picture(form):
    return "_".join([form.type_name(), *form.changed_options().values()]) + ".png"


def use(model):
    """Examples, with the first option where there is one."""
    option = next(iter(model.options), None)
    form = labels.model(make_example_label(model, option)) if option else model
    entries = {"type": form.type_name()} | ({option: getattr(form, option)} if option else {})
    for name in [*form.weights()[:1], *form.shapes()[:1]]:
        entries[name] = form.parameters[name].default
    fits = [f"brdfkit fit FILE -m {name}" for name in dict.fromkeys([model.label(), form.label()])]
    words = {"fits": "\n    ".join(fits), "entries": python(entries), "xml": xml(**entries)}
    return USE.format(label=form.label(), **words)


def python(entries):
    """A dictionary as ruff formats it."""
    return json.dumps(entries, indent=4).replace("\n}", ",\n}")


def xml(type, element="bsdf", **entries):
    """A plugin in a scene file."""
    kinds = {str: "string", int: "integer", float: "float"}
    tags = [f'    <{kinds[v.__class__]} name="{n}" value="{v}"/>' for n, v in entries.items()]
    return "\n".join([f'<{element} type="{type}">', *tags, f"</{element}>"])


def draw(model):
    """Write a model's pictures."""
    import mitsuba as mi

    shown = [form() for form in forms(model)]
    posed = [form(**shown_values(form)) for form in forms(model)]
    balls = bk.render(posed, spp=SPP, size=SIZE).pictures.values()
    for form, linear in zip(shown, balls, strict=True):
        bitmap = np.array(mi.util.convert_to_bitmap(linear))
        write(Image.fromarray(bitmap), FOLDER / picture(form))
    lobes = FOLDER / f"{model.type_name()}_lobes.png"
    bk.plot(shown, theta_i=(15, 45, 75)).savefig(lobes, dpi=100)
    write(Image.open(lobes).convert("RGB"), lobes)


def write(image, path):
    """Write a PNG with a palette: less than half the bytes, and at most 4 of 255 off."""
    image.quantize(256, method=Image.Quantize.MAXCOVERAGE, kmeans=3).save(path, optimize=True)


def problems():
    """What is not as the models' files say, in words."""
    made, files = pages(), {file.name for file in FOLDER.iterdir()}
    pictures = {picture(form) for model in models().values() for form in forms(model)}
    wanted = {*made, *pictures, *(f"{name}_lobes.png" for name in models())}
    found = [f"{name} is missing" for name in sorted(wanted - files)]
    found += [f"{name} belongs to no model" for name in sorted(files - wanted)]
    read = {name: (FOLDER / name).read_text(encoding="utf-8") for name in made if name in files}
    return found + [f"{name} is not up to date" for name, t in read.items() if t != made[name]]


if __name__ == "__main__":
    if "--check" in sys.argv[1:]:
        sys.exit("\n".join(problems()) or 0)
    for name, text in pages().items():
        (FOLDER / name).write_text(text, encoding="utf-8")
    for model in models().values():
        draw(model)
