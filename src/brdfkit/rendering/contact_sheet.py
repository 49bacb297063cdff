"""Draws the contact sheet of a folder of materials: a ball of each material, and its name above."""

from __future__ import annotations

from collections.abc import Mapping
from math import ceil
from typing import TYPE_CHECKING

from brdfkit.core.array_types import FloatArray
from brdfkit.rendering.montage import (
    COLUMNS,
    GAP,
    WHITE_GROUND,
    draw_caption,
    to_image,
    to_visible_srgb,
)

if TYPE_CHECKING:
    from PIL.Image import Image as PillowImage

BALLS_IN_ROW = 6  # number of pictures in a row of a large sheet; a small sheet has COLUMNS


def draw_contact_sheet(balls: Mapping[str, tuple[FloatArray, str]]) -> PillowImage:
    """Draw pictures of balls in a grid, each below its name and a line of text.

    `balls` contains for each name the picture (side, side, 3), in linear sRGB, and the line.
    """
    from PIL import Image, ImageDraw

    mode, paper, *inks = WHITE_GROUND
    across = min(BALLS_IN_ROW if len(balls) > 2 * COLUMNS else COLUMNS, len(balls))
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
        page.paste(to_image(to_visible_srgb(picture), 1), (x, y + caption))
    return page
