"""Makes `docs/formats/`: a page of each file format, and a table of what each format can store.

python docs/tools/make_formats.py         # one minute

The program finds out what a format can store by writing small materials and reading them again.
"""

import re
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from make_models import join_paragraphs, make_table

import brdfkit as bk
from brdfkit.checks.material_subject import draw_direction_pairs
from brdfkit.core.references import find_cited_works
from brdfkit.materials.formats import list_formats

FOLDER = Path(__file__).parents[1] / "formats"
FORMULA = {"alpha_u": 0.3, "diffuse_reflectance": 0.3}
INDEX = """What `bk.load` reads and `bk.save` writes; each also as `.gz` or `.xz`. A file is known
by its content, and by its suffix where that leaves a doubt. The columns are small materials that
were written and read again by `make docs`: *yes* where nothing was lost, *changed* where the
format's page says how, nothing where brdfkit only reads. `brdfkit convert` tells the same of a file
of yours. To add a format:
[CONTRIBUTING](../../CONTRIBUTING.md#add-a-format-a-check-a-thesis-or-a-command)."""
HOLDS = "## What it holds\n\nEach was written and read again."


def make_materials():
    """Return small materials by the property that a format has to store."""
    wi, wo = draw_direction_pairs(300, seed=0, max_degrees=75)
    grey = bk.models()["ggx"](**FORMULA).eval(wi, wo)
    brushed = bk.models()["ggx"](alpha_v=0.6, **FORMULA).eval(wi, wo)
    rgb, bands = np.repeat(grey, 3, axis=1), np.repeat(grey, 8, axis=1)
    names = tuple(f"{nm}nm" for nm in range(400, 720, 40))
    cells = np.random.default_rng(0).uniform(0.1, 0.2, (6, 6, 12, 3))
    samples = bk.Measured.from_samples
    return {
        "samples": samples(wi, wo, rgb, name="samples"),
        "standard errors": samples(wi, wo, rgb, standard_error=0.02 * rgb, name="samples"),
        "wavelengths": samples(wi, wo, bands, channels=names, name="samples"),
        "anisotropic": samples(
            wi, wo, np.repeat(brushed, 3, axis=1), anisotropic=True, name="samples"
        ),
        "a table": bk.Measured.from_table(cells, name="table"),
    }


def try_round_trip(module, material):
    """Return what a format does to a material: a verdict and an explanation.

    The verdict is "yes", "changed" or "no", or "" for a format that brdfkit cannot write.
    """
    if not hasattr(module, "write"):
        return "", "brdfkit does not write this format"
    with TemporaryDirectory() as folder:
        path = Path(folder) / f"it{module.SUFFIXES[0]}"
        try:
            changes = bk.convert(material, path).changes
        except bk.BrdfkitError as error:
            said = str(error).removeprefix(f"{path}: ").split("; ")[0]
            return "no", said
    return ("changed", "; ".join(changes)) if changes else ("yes", "nothing lost")


def make_page_name(module):
    return f"{module.__name__.rpartition('.')[2]}.md"


def list_suffixes(module):
    return ", ".join(f"`{suffix}`" for suffix in module.SUFFIXES)


def split_docstring(module):
    """Return the first sentence and the other text of a format's docstring."""
    first, _, rest = module.__doc__.strip().partition("\n\n")
    return first, re.sub(r"``(.+?)``", r"`\1`", rest)


def make_page(module, found):
    """Return the text of a format's page; `found`: verdicts and explanations by property."""
    first, rest = split_docstring(module)
    can = "read and written" if hasattr(module, "write") else "read"
    folder = "../../src/brdfkit/materials/formats"
    source = f"{folder}/rgl/__init__.py" if hasattr(module, "__path__") else None
    source = source or f"{folder}/{make_page_name(module).replace('.md', '.py')}"
    rows = [(name, words) for name, (_, words) in found.items()]
    cited = "\n".join(f"- {work}" for work in find_cited_works(module.__doc__))
    return join_paragraphs(
        f"# {module.NAME}",
        first,
        f"Suffix {list_suffixes(module)}; {can}.",
        rest,
        *((HOLDS, make_table("given, what came back", rows)) if hasattr(module, "write") else ()),
        cited and f"## References\n\n{cited}",
        f"[The source]({source}) · [all formats](README.md)",
    )


def make_pages():
    """Return the text of each page by its file name."""
    given = make_materials()
    found = {
        m: {name: try_round_trip(m, thing) for name, thing in given.items()} for m in list_formats()
    }
    rows = [
        (
            f"[{m.NAME}]({make_page_name(m)})",
            list_suffixes(m),
            *(verdict for verdict, _ in cells.values()),
        )
        for m, cells in found.items()
    ]
    index = make_table(f"format, suffix, {', '.join(given)}", rows)
    return {"README.md": join_paragraphs("# The file formats", INDEX, index)} | {
        make_page_name(m): make_page(m, cells) for m, cells in found.items()
    }


if __name__ == "__main__":
    FOLDER.mkdir(exist_ok=True)
    for name, text in make_pages().items():
        (FOLDER / name).write_text(text, encoding="utf-8")
