"""Makes docs/exports.md, its figures exports.json and its picture exports.jpg.

    PYTHONPATH=tests/helpers python docs/tools/make_exports.py    # ten minutes

Six materials that brdfkit ships are fitted and exported to every target, and the programs of
tests/helpers/oracles.py that are at hand evaluate the files; the figures of the others are kept.
"""

import json
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

import blender
import numpy as np
import pytest
from oracles import ORACLES
from PIL import Image, ImageDraw, ImageFont

import brdfkit as bk
from brdfkit.core.colours import to_srgb
from brdfkit.core.geometry.directions import from_angles
from brdfkit.exporting.loss import compute_log_error
from brdfkit.exporting.target import COLUMNS
from brdfkit.exporting.targets import list_targets
from brdfkit.images.ball import ball as balls
from brdfkit.images.ball.ball import compute_exposure, draw_ball
from brdfkit.images.ball.lights import LIGHTS
from brdfkit.images.ball.normals import VIEW
from brdfkit.materials.converting import draw_direction_pairs

DOCS = Path(__file__).parents[1]
PAGE, FIGURES, PICTURE = (DOCS / f"exports.{suffix}" for suffix in ("md", "json", "jpg"))
FITS = {  # what it is → the material and the model
    "metal": ("blasted_gold", "ggx"),
    "plastic": ("red_plastic", "ggx"),
    "paint": ("car_paint", "ggx+ggx"),
    "fabric": ("gold_brocade", "burley+ggx"),
    "anisotropic": ("brushed_aluminium", "ggx"),
    "sum": ("satin_plastic", "burley+ggx+ggx"),
}
PAIRS = draw_direction_pairs(50, seed=1)
# The targets in the picture, and the heads of their columns
BALLS = {
    "blender": "Blender",
    "gltf": "glTF",
    "materialx": "MaterialX",
    "mitsuba": "Mitsuba",
    "radiance": "Radiance",
}
ROWS = 128  # of the light's picture
SIZE, CAPTION, FONT = 112, 18, 12  # pixels
BEGIN, END = "<!-- {} begin -->", "<!-- {} end -->"


def measure_target(fit, target, before):
    """Return the figures of one export, and what the target draws; `before` are earlier figures."""
    with TemporaryDirectory() as folder:
        path = Path(folder, f"material{target.suffix}")
        done = bk.export(fit, target.name, path, accept_loss=True)
        truth, drawn = fit.eval(*PAIRS), done.drawn.eval(*PAIRS)
        figures = {
            "log_error": done.log_error,
            "delta_e": done.delta_e,
            "changes": list(done.changes),
            "told": compute_log_error(truth, drawn, *PAIRS),
            "bytes": sum(file.stat().st_size for file in done.paths),
        }
        try:
            values = ORACLES[target.name](done.paths, *PAIRS)
        except (KeyError, pytest.skip.Exception):
            kept = ("measured", "difference")
            found = figures | {name: before[name] for name in kept if name in before}
            return found, done.drawn
        picture = render_in_blender(done.paths[0]) if target.name == "blender" else None
    figures["measured"] = compute_log_error(truth, values, *PAIRS)
    figures["difference"] = float(np.median(np.abs(values / drawn - 1)))
    return figures, picture or done.drawn


def render_in_blender(program):
    """Return a ball in the studio's light, which Cycles path-traces, and its coverage."""
    theta, phi = (np.mgrid[:ROWS, : 2 * ROWS] + 0.5) * np.pi / ROWS
    grey = LIGHTS["studio"](from_angles(theta, phi).reshape(-1, 3)).reshape(ROWS, -1, 1)
    light = np.repeat(grey, 3, axis=2)
    linear = blender.draw_ball(program, SIZE, VIEW, samples=256, environment=light)
    cover = draw_ball(lambda wi, wo: np.ones((len(wi), 1)), SIZE)[1]
    return linear * compute_exposure(), cover


def draw_sheet(rows):
    """Return a picture with a row for each fit: balls of the fit and of targets.

    `rows` holds materials, or pictures with their coverage.
    """
    balls.DIRECTIONS = 240  # so that the pictures have no grain
    heads = list(next(iter(rows.values())))
    step = SIZE + CAPTION
    sheet = Image.new("RGB", (len(heads) * SIZE, len(rows) * step + CAPTION), "white")
    draw, font = ImageDraw.Draw(sheet), ImageFont.load_default(FONT)
    for column, head in enumerate(heads):
        draw.text((column * SIZE + 4, 2), head, "black", font)
    for row, (name, drawn) in enumerate(rows.items()):
        y = CAPTION + row * step
        draw.text((4, y + 2), " ".join((name, *FITS[name])), "black", font)
        for column, thing in enumerate(drawn.values()):
            linear, cover = thing if isinstance(thing, tuple) else draw_ball(thing.eval, SIZE)
            colours = to_srgb(linear) * cover[..., None] + 1 - cover[..., None]
            ball = (np.clip(colours, 0, 1) * 255 + 0.5).astype(np.uint8)
            sheet.paste(Image.fromarray(ball), (column * SIZE, y + CAPTION))
    return sheet


def write_holdings():
    """Return the table of what each target holds."""
    lines = [f"| target | file | what it is | {' | '.join(COLUMNS)} |", "| --- " * 7 + "|"]
    for target in list_targets().values():
        cells = (target.holds[column] for column in COLUMNS)
        lines.append(
            f"| `{target.name}` | {target.suffix} | {target.title} | {' | '.join(cells)} |"
        )
    return lines


def write_losses(figures):
    """Return the table of what was lost, and of what the programs measured."""
    lines = [f"| target | {' | '.join(FITS)} |", "| --- " * (len(FITS) + 1) + "|"]
    for target in list_targets():
        cells = [describe_loss(figures["targets"][target][name]) for name in FITS]
        lines.append(f"| `{target}` | {' | '.join(cells)} |")
    return lines


def describe_loss(figures):
    """Return one cell: ΔE of the ball, and the log errors told and measured."""
    if figures["log_error"] < 1e-6:
        measured = "" if "measured" not in figures else f"; {figures['difference']:.0e}"
        return f"exact{measured}"
    cell = f"ΔE {figures['delta_e']:.2g}; {figures['told']:.2g}"
    return cell if "measured" not in figures else f"{cell} / {figures['measured']:.2g}"


def replace_part(text, name, lines):
    """Return the page's text with other lines between the marks of a part."""
    begin, end = BEGIN.format(name), END.format(name)
    before, rest = text.split(begin)
    return f"{before}{begin}\n{chr(10).join(lines)}\n{rest[rest.index(end) :]}"


def main():
    """Write the page, its figures and its picture."""
    earlier = json.loads(FIGURES.read_text()) if FIGURES.is_file() else {"targets": {}}
    fits, figures, rows = {}, {"fits": {}, "targets": {}}, {}
    for name, (material, label) in FITS.items():
        fits[name] = bk.fit(material, label).model
        values = {k: np.asarray(v).tolist() for k, v in fits[name].free_values.items()}
        figures["fits"][name] = {"model": label, "values": values}
        rows[name] = {"the fit": fits[name]}
    for target in list_targets().values():
        figures["targets"][target.name] = {}
        before = earlier["targets"].get(target.name, {})
        for name, fit in fits.items():
            found, drawn = measure_target(fit, target, before.get(name, {}))
            figures["targets"][target.name][name] = found
            if target.name in BALLS:
                rows[name][BALLS[target.name]] = drawn
            print(target.name, name, describe_loss(found), flush=True)
    FIGURES.write_text(json.dumps(figures, indent=1, ensure_ascii=False) + "\n")
    draw_sheet(rows).save(PICTURE, quality=90)
    text = replace_part(PAGE.read_text(), "holdings", write_holdings())
    PAGE.write_text(replace_part(text, "losses", write_losses(figures)))
    return 0


if __name__ == "__main__":
    sys.exit(main())
