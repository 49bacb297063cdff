"""Makes `docs/plugins/`: a page for each plugin that is no model, and an index of all plugins.

python docs/tools/make_plugins.py              # the pages, at once
python docs/tools/make_plugins.py --check      # exits with 1 if a page is not up to date
"""

import math
import sys
from pathlib import Path

from make_models import (
    join_paragraphs,
    list_references,
    make_table,
    make_xml_element,
    read_docstring,
)

from brdfkit.core.discovery import plugin_files
from brdfkit.core.discovery.plugin_files import KINDS, MODELS
from brdfkit.model.labels import find_model_in

FOLDER = Path(__file__).parents[1] / "plugins"
TOP = "../../plugins"
INDEX = """A file in [`plugins/KIND/`]({top}) is a plugin of Mitsuba's, and its name the type. After
`import brdfkit` it is known in every variant, in `mitsuba.load_dict`, in scene files and to
`brdfkit render SCENE.xml`. `brdfkit plugins` lists them, `brdfkit check NAME` says whether one does
what its kind should, `brdfkit.load_plugins("my_plugins/")` adds yours."""
TAGS = {"bsdfs": "bsdf", "emitters": "emitter", "integrators": "integrator", "phase": "phase"}


def make_pages():
    """Return the text of each page by its file name."""
    rows = []
    for kind in KINDS:
        for name, source in find_shipped_plugins(kind).items():
            link = f"../models/{name}.md" if is_model(kind, source) else f"{name}.md"
            rows.append((f"`{kind}`", f"[{name}]({link})", read_docstring(source)[1]))
    index = join_paragraphs(
        "# The plugins", INDEX.format(top=TOP), make_table("kind, plugin, what it is", rows)
    )
    own = [
        (k, n, s) for k in KINDS for n, s in find_shipped_plugins(k).items() if not is_model(k, s)
    ]
    return {"README.md": index} | {f"{n}.md": make_page(k, n, s) for k, n, s in own}


def find_shipped_plugins(kind):
    """Return the source files of brdfkit's own plugins of a `kind` by name, without a user's."""
    found = plugin_files.find_plugins(kind).items()
    return {
        n: s
        for n, s in found
        if plugin_files.import_plugin(s).__name__.startswith(plugin_files.OWN)
    }


def is_model(kind, source):
    return kind == MODELS and find_model_in(source) is not None


def make_page(kind, name, source):
    """Return the text of a plugin's page; `source`: its file."""
    title, sentence, text = read_docstring(source)
    settings = getattr(plugin_files.import_plugin(source), "PARAMETERS", {})
    rows = [
        (f"`{n}`", format_default(s), *format_bounds(s), s.meaning) for n, s in settings.items()
    ]
    return join_paragraphs(
        *(f"# {title}", sentence, text),
        rows and make_table("parameter, default, from, to, meaning", rows),
        f"```xml\n{make_scene_element(kind, name, settings)}\n```",
        list_references(source),
        f"[The source]({TOP}/{kind}/{name}.py) · [all plugins](README.md)",
    )


def format_default(setting):
    if isinstance(setting.default, str):
        return setting.default and f"`{setting.default}`"
    if isinstance(setting.default, bool):
        return str(setting.default).lower()
    if isinstance(setting.default, tuple):
        return ", ".join(f"{value:g}" for value in setting.default)
    return "" if setting.default is None else f"{setting.default:g}"


def format_bounds(setting):
    if setting.bounds is None:
        return "", ""
    return ["∞" if math.isinf(b) else f"{b:g}".replace("-", "−") for b in setting.bounds]


def make_scene_element(kind, name, settings):
    """Return an XML example of the plugin for a scene file, with its numbers at their defaults."""
    defaults = {n: setting.default for n, setting in settings.items()}
    numbers = {n: d for n, d in defaults.items() if type(d) in (int, float)}
    return make_xml_element(name, TAGS.get(kind, kind.removesuffix("s")), **numbers)


def find_problems():
    """Return sentences on pages that are missing, superfluous or not up to date."""
    made, files = make_pages(), {file.name for file in FOLDER.iterdir()}
    found = [f"{name} is missing" for name in sorted(made.keys() - files)]
    found += [f"{name} belongs to no plugin" for name in sorted(files - made.keys())]
    read = {name: (FOLDER / name).read_text(encoding="utf-8") for name in made if name in files}
    return found + [f"{name} is not up to date" for name, t in read.items() if t != made[name]]


if __name__ == "__main__":
    if "--check" in sys.argv[1:]:
        sys.exit("\n".join(find_problems()) or 0)
    FOLDER.mkdir(exist_ok=True)
    for name, text in make_pages().items():
        (FOLDER / name).write_text(text, encoding="utf-8")
