"""Makes `docs/environments.md`, a page of the environment maps that come with brdfkit.

It also draws the picture of that page, and the map of a compass for a how-to.

python docs/tools/make_environments.py           # some minutes
"""

from pathlib import Path

import numpy as np
from make_models import join_paragraphs, make_table
from PIL import Image, ImageDraw, ImageFont

import brdfkit as bk
from brdfkit.core import catalogue
from brdfkit.core.colours import luminance, to_srgb
from brdfkit.lighting.environments.map_files import read_map

PAGE = Path(__file__).parents[1] / "environments.md"
COMPASS = PAGE.parent / "how_to" / "compass.jpg"
SHOWN = [name for name in catalogue.list_environments() if name != "compass"]
BALLS = ("red_plastic", "car_paint", "blasted_gold")
HEIGHT, SPP, LINE, GAP = 192, 256, 30, 8
TEXT = """They come with brdfkit, are free to use, and are found by their names where a map is
asked for: `bk.render("car_paint", environment="studio")`, and on the command line
`brdfkit render car_paint --envmap studio`.
[How they were made](../data/environments/README.md)."""
PICTURE = "![Each map, and balls of three materials in its light](environments.jpg)"
BELOW = """*Light in 1 %*: the share of it that comes from the brightest 1 % of all directions, by
`brdfkit info NAME`, which takes a map of yours as well and says what is doubtful in it; `-o` draws
the map, the blocks into which [`kdtree_envmap`](plugins/kdtree_envmap.md) cuts it, and how its
light is spread.

`compass` is for [maps that are mirrored or turned](how_to/mirrored_environment.md). Where there are
others, free ones too, says `brdfkit data`."""


def make_page():
    """Return the text of the page."""
    rows = []
    for name in SHOWN:
        map, found = catalogue.list_environments()[name], bk.environments.audit(name)
        share, stops = found.brightest_share, np.log2(found.largest / found.median)
        rows.append((f"`{name}`", map.what, f"{share:.0%}".replace("%", " %"), f"{stops:.0f}"))
    figures = make_table("map, what it is, light in 1 %, stops from median to max", rows)
    return join_paragraphs("# The environments", TEXT, PICTURE, figures, BELOW)


def draw_maps_and_balls():
    """Return a picture of the maps, each next to balls that it lights."""
    wide = 2 * HEIGHT + len(BALLS) * (HEIGHT + GAP)
    sheet = Image.new("RGB", (wide, len(SHOWN) * (HEIGHT + GAP + LINE)), "white")
    draw, font = ImageDraw.Draw(sheet), ImageFont.load_default(18)
    for row, name in enumerate(SHOWN):
        top = row * (HEIGHT + GAP + LINE)
        draw.text((4, top + LINE // 2), name, "black", font, anchor="lm")
        rgb = read_map(catalogue.find_environment_file(name))
        exposure = 0.18 / np.exp(np.log(luminance(rgb) + 1e-4).mean())
        sheet.paste(to_screen_image(rgb * exposure).resize((2 * HEIGHT, HEIGHT)), (0, top + LINE))
        balls = bk.render(BALLS, spp=SPP, size=HEIGHT, environment=name).pictures.values()
        for column, ball in enumerate(balls):
            place = 2 * HEIGHT + GAP + column * (HEIGHT + GAP), top + LINE
            sheet.paste(to_screen_image(ball), place)
    return sheet


def to_screen_image(linear):
    return Image.fromarray((255 * to_srgb(linear) + 0.5).astype(np.uint8))


if __name__ == "__main__":
    PAGE.write_text(make_page(), encoding="utf-8")
    draw_maps_and_balls().save(PAGE.with_suffix(".jpg"), quality=88, optimize=True)
    compass = to_screen_image(read_map(catalogue.find_environment_file("compass")))
    compass.resize((768, 384), Image.Resampling.NEAREST).save(COMPASS, quality=90, optimize=True)
