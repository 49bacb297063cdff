"""The page of a sweep: one HTML file that needs no other, for a light and for a dark screen."""

import math
import os
from html import escape
from pathlib import Path
from urllib.parse import quote

from brdfkit.core.files import write_safely
from brdfkit.core.names import join_words, to_printable
from brdfkit.core.pages.page import read_template
from brdfkit.core.version import __version__
from brdfkit.fitting.sweeping import tables
from brdfkit.materials.measured.albedos import ANGLES
from brdfkit.regression import losses
from brdfkit.regression.albedo_cells import format_albedo, is_wrong, mean_albedos
from brdfkit.regression.light import WRONG

STYLE = """
:root { color-scheme: light dark; --paper: #fff; --ink: #1d1d1f; --soft: #6b6b70; --line: #dcdce0;
  --tint: #b9dfc0; --bad: #b3261e; }
@media (prefers-color-scheme: dark) {
  :root { --paper: #17181a; --ink: #e8e8ea; --soft: #a0a0a8; --line: #3a3b40;
    --tint: #2c6a3c; --bad: #ff8a80; }
}
body { margin: 2rem auto; max-width: 75rem; padding: 0 1rem; background: var(--paper);
  color: var(--ink); font: 15px/1.5 system-ui, sans-serif; }
h1 { font-size: 1.5rem; margin: 0; } h2 { font-size: 1.1rem; margin: 2rem 0 .5rem; }
p { margin: .3rem 0; } .soft, footer { color: var(--soft); }
.wide { overflow-x: auto; margin-top: .6rem; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; }
th, td { padding: .25rem .7rem; text-align: left; border-bottom: 1px solid var(--line);
  white-space: nowrap; vertical-align: top; }
th { font-weight: 600; }
th button { all: unset; cursor: pointer; }
th button:focus-visible { outline: 2px solid; outline-offset: 2px; }
th[aria-sort=ascending]::after { content: " ▲"; } th[aria-sort=descending]::after { content: " ▼"; }
.number, .failed { text-align: right; }
.errors th:first-child { position: sticky; left: 0; background: var(--paper); }
tfoot, tfoot th { color: var(--soft); font-weight: 400; }
td.best { font-weight: 600; }
td.near { background: color-mix(in srgb, var(--tint) calc(var(--near) * 1%), transparent); }
td.failed, li, .bad { color: var(--bad); }
.bad::before { content: "! "; font-weight: 700; }
td.remarks { white-space: normal; min-width: 16rem; }
a { color: inherit; text-decoration-color: var(--line); text-underline-offset: .2em; }
a:hover { text-decoration-color: currentColor; }
footer { margin-top: 2rem; font-size: .9rem; }
"""
NUMBER = "number"  # the class of a cell
ALBEDOS = (
    f"Under {join_words([f'{angle:g}°' for angle in ANGLES])}: the albedo of the fit, the share of "
    "the light from that angle to the normal that it reflects, the mean over the channels; below "
    "it that of the measurement."
)
FAR = 4.0  # times the error of the best: from there a cell has no tint

# What is told under the head of each quantity
BY_FITTED = (
    "Errors are by the very samples that the models were fitted to, and the more numbers a model "
    "has, the more they flatter it"
)
UNTOLD = (
    "; fit --judge, or sweep(..., judge=True), tells errors in directions held out, and pictures"
)
TOLD = {
    "held_out": "The error of fits by the loss alone, in directions that they did not see: all in "
    "turn, a fifth at a time.",
    "psnr": "The peak signal-to-noise ratio of a ball's picture beside the measurement's, under "
    "several lights, as a screen shows it: the more the better.",
}


def write(sweep, path):
    """Write the page of a `Sweep` to the file `path`."""
    path = Path(path)
    with write_safely(path) as beside:
        beside.write_text(page(sweep, path.parent), encoding="utf-8")


def page(sweep, folder):
    """The page as text; `folder`: where it will be, for its links."""
    materials = tables.by_material(sweep)
    models = list(dict.fromkeys(row.model for row in sweep.rows))
    title = f"{_count(models, 'model')} fitted to {_count(materials, 'material')}"
    parts = [f"<h1>{title}</h1>", f'<p class="soft">{_text(sweep.summary)}</p>']
    for quantity in tables.quantities(sweep):
        told = _text(_tell(sweep, quantity))
        parts += [f"<h2>{quantity.title}</h2>", f'<p class="soft">{told}</p>']
        parts.append(_comparison(sweep, materials, models, quantity, folder))
    if sweep.problems:
        items = "".join(f"<li>{_text(problem)}</li>" for problem in sweep.problems)
        parts += ["<h2>Failures</h2>", f"<ul>{items}</ul>"]
    if sweep.fits:
        parts += ["<h2>Every fit</h2>", f'<p class="soft">{ALBEDOS}</p>', _fits(sweep)]
    return (
        '<!doctype html>\n<html lang="en"><head><meta charset="utf-8">'
        '<meta name="viewport" content="width=device-width">'
        f"<title>{title}</title><style>{STYLE}</style></head>\n<body>\n"
        + "\n".join(parts)
        + f"\n<footer>Made by brdfkit {__version__}.</footer>\n"
        + f'<script type="module">{read_template("sort_tables.js")}</script></body></html>\n'
    )


def _tell(sweep, quantity):
    """What to know of a quantity's table, in sentences."""
    told = TOLD.get(quantity.name)
    if told is None:
        loss = losses.named[sweep.rows[0].loss]
        judged = len(tables.quantities(sweep)) > 1
        told = (
            f"Loss {loss.name}: {loss.meaning}. The best of a row is bold, the others have the "
            "more colour the nearer they come to it; colours compare within a row only. "
            f"{BY_FITTED}{'' if judged else UNTOLD}.{_explain_marks(sweep)}"
        )
    return told


def _comparison(sweep, materials, models, quantity, folder):
    """The table of a quantity, materials by models."""
    columns, rows, foot = tables.compare(sweep, quantity)
    body = []
    for (material, found), row in zip(materials.items(), rows, strict=True):
        best = quantity.best(found.values())
        cells = "".join(_number(found.get(model), best, quantity, folder) for model in models)
        file = _text(next(iter(found.values())).file)
        name = f'<th scope="row" title="{file}">{_text(material)}</th>'
        body.append(f"<tr>{name}{cells}{_cells([row[-1]])}</tr>")
    sums = [f'<tr><th scope="row">{name}</th>{_cells(texts, NUMBER)}</tr>' for name, *texts in foot]
    return _table("errors", columns, body, sums)


def _number(row, best, quantity, folder):
    """The cell of one fit; `best`: the row of the best number of the same material."""
    if row is None:
        return "<td></td>"
    if not row.fit:
        return f'<td class="failed" title="{_text(row.message)}">failed</td>'
    number = quantity.of(row)
    if math.isnan(number):
        return f'<td class="{NUMBER}">–</td>'
    near = round(100 * max(0.0, 1 - math.log(quantity.ratio(row, best)) / math.log(FAR)))
    kind = f"{NUMBER} near best" if number == quantity.of(best) else f"{NUMBER} near"
    kind += " bad" if row.fit.warnings else ""
    text = quantity.format(number)
    if row.saved:
        link = quote(Path(os.path.relpath(row.saved, folder)).as_posix())
        text = f'<a href="{link}">{text}</a>'
    hint = _text("; ".join([f"{number:.9g}", *row.fit.warnings]))
    return f'<td class="{kind}" style="--near: {near}" title="{hint}">{text}</td>'


def _explain_marks(sweep):
    """What marks the fits whose light is wrong; nothing where there are none."""
    if not sweep.warned:
        return ""
    return (
        " Marked are fits whose light is wrong: they reflect more than arrives, or differ by more "
        f"than a factor of {WRONG:g} from the measured albedo."
    )


def _fits(sweep):
    """Every fit with its numbers, its albedos, over those of the measurement, and its values."""
    angles = [f">{angle:g}°" for angle in ANGLES]
    numbers = ">parameters", ">samples", ">time [s]"
    quantities = tables.quantities(sweep)
    judged = [f">{quantity.head}" for quantity in quantities[1:]]
    columns = "material", "model", ">error", *judged, *angles, *numbers, "remarks", ""
    body = []
    for row in sweep.rows:
        if row.fit:
            numbers = row.parameters, f"{row.samples:,}", f"{row.seconds:.2f}"
            albedos = map(_albedo, *mean_albedos(row.fit.albedo))
            bounds = [f"on a bound: {', '.join(row.at_bounds)}"] if row.at_bounds else []
            remarks = "; ".join([*bounds, *row.fit.notes, row.message])
            values = "<br>".join(_text(f"{n} = {_short(v)}") for n, v in row.fit.values.items())
            body.append(
                f"<tr>{_cells([row.material, row.model])}"
                f"{_cells([q.format(q.of(row)) for q in quantities], NUMBER)}{''.join(albedos)}"
                f"{_cells(numbers, NUMBER)}{_cells([remarks], 'remarks')}"
                f"<td><details><summary>values</summary>{values}</details></td></tr>"
            )
    return _table("fits", columns, body)


def _albedo(own, measured):
    """The cell of an albedo of a fit, above the measured one."""
    kind = "bad" if is_wrong(own, measured) else ""
    texts = format_albedo(own), format_albedo(measured)
    return (
        f'<td class="{NUMBER}"><span class="{kind}">{texts[0]}</span><br>'
        f'<span class="soft">{texts[1]}</span></td>'
    )


def _table(kind, columns, body, foot=()):
    """A table of rows; a column whose name begins with ">" is one of numbers."""
    head = "".join(
        f'<th scope="col" class="{NUMBER if name.startswith(">") else ""}">'
        f"{_text(name.removeprefix('>'))}</th>"
        for name in columns
    )
    end = "<tfoot>" + "\n".join(foot) + "</tfoot>" if foot else ""
    return (
        f'<div class="wide"><table class="{kind} sortable"><thead><tr>{head}</tr></thead>\n<tbody>'
        + "\n".join(body)
        + f"</tbody>{end}</table></div>"
    )


def _cells(texts, kind=""):
    return "".join(f'<td class="{kind}">{_text(text)}</td>' for text in texts)


def _short(value):
    """A value as text."""
    return "  ".join(f"{v:.5g}" for v in (value if isinstance(value, tuple) else [value]))


def _count(things, what):
    return f"{len(things)} {what}{'' if len(things) == 1 else 's'}"


def _text(text):
    """Any text, escaped for the page."""
    return escape(to_printable(text))
