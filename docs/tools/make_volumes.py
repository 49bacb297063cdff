"""Makes `docs/volumes.jpg`: volumes that brdfkit generates, drawn by each renderer.

All settings are defaults.

python docs/tools/make_volumes.py           # two minutes
"""

from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw, ImageFont

import brdfkit as bk
from brdfkit.core.colours import to_srgb
from brdfkit.rendering.volumes.scene import RENDERERS

PICTURE = Path(__file__).parents[1] / "volumes.jpg"
VOLUMES = ("smoke", "marschner_lobb")
SIZE, VOXELS, SPP, LINE = 250, 128, 128, 28


def draw_renderers():
    """Return the picture with a row for each volume and a column for each renderer."""
    wide, high = len(RENDERERS) * SIZE, LINE + len(VOLUMES) * SIZE
    sheet = Image.new("RGB", (wide, high), "white")
    draw, font = ImageDraw.Draw(sheet), ImageFont.load_default(18)
    for column, renderer in enumerate(RENDERERS):
        draw.text((column * SIZE + 4, LINE // 2), renderer, "black", font, anchor="lm")
        for row, name in enumerate(VOLUMES):
            volume = bk.volumes.load(name, size=VOXELS)
            shown = bk.render_volume(volume, renderer=renderer, spp=SPP, size=SIZE)
            rgb = np.clip(to_srgb(shown.pictures[name]), 0, 1)
            sheet.paste(
                Image.fromarray((255 * rgb + 0.5).astype(np.uint8)),
                (column * SIZE, LINE + row * SIZE),
            )
    return sheet


if __name__ == "__main__":
    draw_renderers().save(PICTURE, quality=88)
