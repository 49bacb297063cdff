"""The picture of a folder of materials: a ball of each under its name."""

from math import ceil

from brdfkit.rendering.montage import COLUMNS, GAP, WHITE_GROUND, displayed, draw_caption, tile

ACROSS = 6  # balls in a row; COLUMNS where there are fewer materials than two such rows


def contact_sheet(balls):
    """A `PIL.Image` of pictures (side, side, 3), linear, by name, and a line on each:
    ``{name: (picture, line)}``."""
    from PIL import Image, ImageDraw

    mode, paper, *inks = WHITE_GROUND
    across = min(ACROSS if len(balls) > 2 * COLUMNS else COLUMNS, len(balls))
    height, width = next(iter(balls.values()))[0].shape[:2]
    text = max(11, width // 15)
    caption = round(3.2 * text)
    row = caption + height + GAP
    page = Image.new(
        mode, (GAP + across * (width + GAP), GAP + ceil(len(balls) / across) * row), paper
    )
    draw = ImageDraw.Draw(page)
    for place, (name, (picture, line)) in enumerate(balls.items()):
        x, y = GAP + place % across * (width + GAP), GAP + place // across * row
        draw_caption(draw, (x, y), name, line, width, text, inks)
        page.paste(tile(displayed(picture), 1), (x, y + caption))
    return page
