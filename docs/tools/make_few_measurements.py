"""Makes the pictures of `docs/how_to/few_measurements.md`.

    BRDFKIT_DATA=FOLDER python docs/tools/make_few_measurements.py    # two minutes

Balls of materials as measured, and as completed from 8, 20 and 64 of their values. FOLDER contains
third-party files, which brdfkit does not ship.
"""

import os
import sys
from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw, ImageFont

import brdfkit as bk
from brdfkit.core.colours import to_srgb
from brdfkit.images.hatching import hatch
from brdfkit.images.thumbnails import find_levels
from brdfkit.materials.measured.evidence import find_evidence

PICTURES = Path(__file__).parents[1] / "how_to"
MATERIALS = {
    "car paint": "car_paint",
    "blasted gold": "blasted_gold",
    "purple paint, metallic": "minidiff_paints/Metal_Purpule.astm.xz",
    "iris paint with flakes": "rgl/cc_iris_purple_gem_rgb.bsdf",
    "satin": "rgl/satin_rosaline_rgb.bsdf",
    "green felt": "rgl/acrylic_felt_green_rgb.bsdf",
}
COUNTS = 8, 20, 64
NOISE, SEED = 0.05, 1
SIZE, CAPTION, FONT = 144, 18, 12  # pixels


def complete_from(truth, plan):
    """Return a material completed from noisy values of the `truth` at the directions of a plan."""
    values = truth.eval(plan.wi, plan.wo)
    values *= 1 + NOISE * np.random.default_rng(SEED).normal(size=values.shape)
    few = bk.Measured.from_samples(plan.wi, plan.wo, values, name=truth.name)
    return bk.complete(few, noise=NOISE)


def draw_evidence(completed):
    """Return a preview of a ball, hatched where its light was inferred or guessed."""
    levels = find_levels(completed.eval, lambda wi, wo: find_evidence(completed, wi, wo), SIZE)
    return hatch(draw_balls([completed])[0], levels)


def draw_balls(materials):
    """Return pictures of balls under the studio's softboxes, sRGB in 8 bits."""
    from brdfkit.images.ball.ball import draw_ball

    pictures = []
    for material in materials:
        linear, cover = draw_ball(material.rgb.eval, SIZE)
        colours = to_srgb(linear) * cover[..., None] + 1 - cover[..., None]
        pictures.append((np.clip(colours, 0, 1) * 255 + 0.5).astype(np.uint8))
    return pictures


def make_sheet(folder):
    """Return one picture: a row for each material, with a column for each number of values."""
    plans = [bk.plan(count) for count in COUNTS]
    heads = ["measured", *(f"{count} values" for count in COUNTS), "20: what is a guess"]
    row = SIZE + CAPTION
    sheet = Image.new("RGB", (len(heads) * SIZE, len(MATERIALS) * row + CAPTION), "white")
    draw, font = ImageDraw.Draw(sheet), ImageFont.load_default(FONT)
    for column, head in enumerate(heads):
        draw.text((column * SIZE + 4, 2), head, "black", font)
    for number, (title, name) in enumerate(MATERIALS.items()):
        truth = bk.load(folder / name if "/" in name else name).rgb
        completed = [complete_from(truth, plan) for plan in plans]
        y = CAPTION + number * row
        draw.text((4, y + 2), title, "black", font)
        pictures = [*draw_balls([truth, *completed]), draw_evidence(completed[1])]
        for column, picture in enumerate(pictures):
            sheet.paste(Image.fromarray(picture), (column * SIZE, y + CAPTION))
        for column, one in enumerate(completed, 1):
            if "unlike" in one.info:
                draw.text((column * SIZE + 4, y + 2), "unlike the prior's", "#a04000", font)
        print(title, [one.info.get("unlike", "")[:40] for one in completed], flush=True)
    return sheet


def main():
    """Write the pictures."""
    folder = os.environ.get("BRDFKIT_DATA")
    if not folder:
        print("BRDFKIT_DATA names no folder of measurements", file=sys.stderr)
        return 2
    make_sheet(Path(folder)).save(PICTURES / "few_measurements.jpg", quality=88)
    paint, plan = bk.load("car_paint"), bk.plan(20)
    completed = complete_from(paint, plan)
    figure = bk.plot([paint, completed], theta_i=[20, 50, 75])
    figure.savefig(PICTURES / "few_measurements_lobes.png", dpi=90)
    plan.picture().savefig(PICTURES / "few_measurements_plan.png", dpi=90)
    return 0


if __name__ == "__main__":
    sys.exit(main())
