"""Makes `docs/models/`: a page for each model, with balls and plots of lobes, and an index.

python docs/tools/make_models.py              # pages and pictures, in two minutes
python docs/tools/make_models.py ggx ward     # all pages, but only the pictures of these models
python docs/tools/make_models.py --check      # exits with 1 if a page is not up to date
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


def make_pages():
    """Return the text of each page by its file name."""
    rows = []
    for name, model in find_shipped_models().items():
        options = "<br>".join(f"`{n}`: {format_choices(o)}" for n, o in model.options.items())
        rows.append(
            (
                f"[{name}]({name}.md)",
                read_docstring(model)[1],
                options,
                make_ball_tag(model, SIZE // 2),
            )
        )
    index = join_paragraphs(
        "# The models", INDEX, make_table("model, what it is, options, ball", rows)
    )
    return {"README.md": index} | {
        f"{name}.md": make_page(m) for name, m in find_shipped_models().items()
    }


def find_shipped_models():
    """Return brdfkit's own model classes by name, without a user's that were loaded."""
    found = bk.models().items()
    return {name: m for name, m in found if m.__module__.startswith("brdfkit.plugins.")}


def make_page(model):
    """Return the text of a model's page; `model`: its class."""
    name, (title, sentence, text), shown = (
        model.type_name(),
        read_docstring(model),
        list_forms(model),
    )
    balls = make_table(
        ", ".join(f"`{f.label()}`" for f in shown), [[make_ball_tag(f, SIZE) for f in shown]]
    )
    values = ", ".join(f"`{n}` = {v}" for n, v in find_ball_values(model).items())
    parameters = [make_parameter_row(*item) for item in model.parameters.items()]
    options = [
        (f"`{n}`", o.default, format_choices(o), o.meaning) for n, o in model.options.items()
    ]
    return join_paragraphs(
        *(f"# {title}", sentence, balls, f"The ball has {values or 'the defaults'}.", text),
        make_table("parameter, default, bounds, meaning, per channel", parameters),
        EXPOSED,
        options and make_table("option, default, choices, meaning", options),
        f"![Polar plots of {name} in the plane of incidence]({name}_lobes.png)",
        *("## Use", make_usage_example(model)),
        list_references(model),
        f"[The source](../../plugins/bsdfs/{name}.py) · [all models](README.md)",
    )


def join_paragraphs(*texts):
    return "\n\n".join(filter(None, texts)) + "\n"


def make_table(head, rows):
    lines = [head.split(", "), ["---"] * len(head.split(", ")), *rows]
    return "\n".join(
        "| " + " | ".join(str(c).replace("|", "∣") for c in line) + " |" for line in lines
    )


def read_docstring(source):
    """Return (title, first sentence, other text) of a plugin's docstring, with set formulas."""
    found = plugin_page(source)
    text = set_formulas("\n".join(found.lines).strip("\n"))
    return found.title, found.sentence[0].upper() + found.sentence[1:], text


def list_references(source):
    """Return the section of a page with the works that the plugin's docstring cites."""
    found = plugin_page(source).references
    return found and "## References\n\n" + "\n".join(f"- {work}" for work in found)


def make_parameter_row(name, p):
    default = f"`{p.follows}`" if p.follows else f"{p.default:.4g}"
    bounds = "{:g} to {:g}".format(*p.bounds).replace("-", "−").replace("inf", "∞")
    return f"`{name}`", default, bounds, p.meaning, "yes" if p.linear else ""


def list_forms(model):
    """Return a model class and its forms by those options that do not change its parameters."""
    words = [(n, w) for n, o in model.options.items() for w in o.choices or () if w != o.default]
    others = [model.configured(**{name: word}) for name, word in words if isinstance(word, str)]
    return [model, *(other for other in others if other.parameters == model.parameters)]


def make_ball_tag(form, width):
    return f'<img src="{make_picture_name(form)}" width="{width}" alt="A ball of {form.label()}">'


def find_ball_values(form):
    """Return the parameters of the ball in a form's picture, from `PICTURE` in its file."""
    chosen = getattr(sys.modules[form.__module__], "PICTURE", {})
    return {name: value for name, value in chosen.items() if name in form.parameters}


def make_picture_name(form):
    return "_".join([form.type_name(), *form.changed_options().values()]) + ".png"


def make_usage_example(model):
    """Return examples for command line, Python and scene files, with the first option."""
    option = next(iter(model.options), None)
    form = labels.model(make_example_label(model, option)) if option else model
    entries = {"type": form.type_name()} | ({option: getattr(form, option)} if option else {})
    for name in [*form.weights()[:1], *form.shapes()[:1]]:
        entries[name] = form.parameters[name].default
    fits = [f"brdfkit fit FILE -m {name}" for name in dict.fromkeys([model.label(), form.label()])]
    words = {
        "fits": "\n    ".join(fits),
        "entries": format_dictionary(entries),
        "xml": make_xml_element(**entries),
    }
    return USE.format(label=form.label(), **words)


def format_dictionary(entries):
    """Return a dictionary as Python code, in the format of ruff."""
    return json.dumps(entries, indent=4).replace("\n}", ",\n}")


def make_xml_element(type, element="bsdf", **entries):
    """Return the XML of a plugin in a scene file, with parameters as `entries`."""
    kinds = {str: "string", int: "integer", float: "float"}
    tags = [f'    <{kinds[v.__class__]} name="{n}" value="{v}"/>' for n, v in entries.items()]
    return "\n".join([f'<{element} type="{type}">', *tags, f"</{element}>"])


def draw_pictures(model):
    """Write the pictures of a model: balls of its forms, and a plot of its lobes."""
    import mitsuba as mi

    shown = [form() for form in list_forms(model)]
    posed = [form(**find_ball_values(form)) for form in list_forms(model)]
    balls = bk.render(posed, spp=SPP, size=SIZE).pictures.values()
    for form, linear in zip(shown, balls, strict=True):
        bitmap = np.array(mi.util.convert_to_bitmap(linear))
        write_png(Image.fromarray(bitmap), FOLDER / make_picture_name(form))
    lobes = FOLDER / f"{model.type_name()}_lobes.png"
    bk.plot(shown, theta_i=(15, 45, 75)).savefig(lobes, dpi=100)
    write_png(Image.open(lobes).convert("RGB"), lobes)


def write_png(image, path):
    """Write an image as PNG with a palette: half the size, with errors of at most 4 of 255."""
    image.quantize(256, method=Image.Quantize.MAXCOVERAGE, kmeans=3).save(path, optimize=True)


def find_problems():
    """Return sentences on pages and pictures that are missing, superfluous or not up to date."""
    made, files = make_pages(), {file.name for file in FOLDER.iterdir()}
    pictures = {
        make_picture_name(form)
        for model in find_shipped_models().values()
        for form in list_forms(model)
    }
    wanted = {*made, *pictures, *(f"{name}_lobes.png" for name in find_shipped_models())}
    found = [f"{name} is missing" for name in sorted(wanted - files)]
    found += [f"{name} belongs to no model" for name in sorted(files - wanted)]
    read = {name: (FOLDER / name).read_text(encoding="utf-8") for name in made if name in files}
    return found + [f"{name} is not up to date" for name, t in read.items() if t != made[name]]


if __name__ == "__main__":
    if "--check" in sys.argv[1:]:
        sys.exit("\n".join(find_problems()) or 0)
    for name, text in make_pages().items():
        (FOLDER / name).write_text(text, encoding="utf-8")
    for name, model in find_shipped_models().items():
        if name in sys.argv[1:] or not sys.argv[1:]:
            draw_pictures(model)
