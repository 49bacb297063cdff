"""The files of a rendering: a multi-part OpenEXR with everything, and a montage to look at."""

import json
from math import ceil, isfinite
from pathlib import Path

import numpy as np

from brdfkit.core.colours import to_srgb
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.json_values import to_json
from brdfkit.core.names import to_printable
from brdfkit.core.version import __version__
from brdfkit.images.errors.colour_difference import ciede2000

COLUMNS = 4
TILE = 320  # narrower pictures are enlarged to this width [pixels], so that captions fit
GAP = 20
# The mode of a page, the colour of its paper, and those of names and of what is said of them
WHITE_GROUND = "RGB", (255, 255, 255), (26, 26, 26), (105, 105, 105)
# In notebooks, light or dark: a middle grey, on a ground that is transparent
ANY_GROUND = "RGBA", (125, 125, 125, 0), (125, 125, 125, 255), (125, 125, 125, 255)
MOST = 20  # ΔE of the brightest false colour; fixed, so that montages can be compared


def picture_suffix(path):
    """The suffix of the `Path`, .exr or .png; an error for any other."""
    suffix = path.suffix.lower()
    if suffix not in (".exr", ".png"):
        raise BrdfkitError(f"{path}: pictures are written as .exr or .png; choose one of them.")
    return suffix


def write_exr(rendering, path):
    """Write every picture, difference and error as a named part; see `Rendering.write`."""
    import OpenEXR

    parts = []
    # title of a part → (name of the picture, its values)
    named = {name: (name, p) for name, p in rendering.pictures.items()}
    named |= {f"difference: {n}": (n, d) for n, d in rendering.differences.items()}
    if rendering.standard_error is not None:
        first = rendering.reference
        named[f"standard error: {first}"] = first, rendering.standard_error
    for title, (name, picture) in named.items():
        header = {
            "type": OpenEXR.scanlineimage,
            "compression": OpenEXR.ZIP_COMPRESSION,
            "spp": rendering.spp,
            "seed": rendering.seed,
            "brdfkit": __version__,
            "parameters": json.dumps(to_json(rendering.parameters.get(name, {}))),
        }
        if isfinite(rendering.noise_floor):
            header["noise_floor"] = rendering.noise_floor
        channels = {c: np.ascontiguousarray(picture[..., i]) for i, c in enumerate("RGB")}
        parts.append(OpenEXR.Part(header, channels, to_printable(title)))
    try:
        OpenEXR.File(parts).write(str(path))
    except RuntimeError as error:  # a full disk, for instance
        raise OSError(str(error)) from error


def montage(rendering, on_any_ground=False):
    """A `PIL.Image` of the pictures with captions, up to four in a row.

    On white; or `on_any_ground`, for notebooks, with transparency.

    Below each picture is its colour difference to the reference (CIEDE2000), in false colours that
    a legend explains.
    """
    from PIL import Image, ImageDraw

    captions, differences = rendering.captions, colour_differences(rendering)
    tone = rendering.tone_mapping
    brightest = tone.brightest_of(rendering.pictures[rendering.reference])
    names = list(rendering.pictures)

    # sizes [pixels]
    zoom = ceil(TILE / rendering.pictures[names[0]].shape[1])
    height, width = (zoom * n for n in rendering.pictures[names[0]].shape[:2])
    text = max(15, width // 24)
    caption = round(3.2 * text)
    row = caption + height + GAP + (height + GAP if differences else 0)
    columns, rows = min(len(names), COLUMNS), ceil(len(names) / COLUMNS)

    extent = GAP + columns * (width + GAP), GAP + rows * row
    mode, paper, *inks = ANY_GROUND if on_any_ground else WHITE_GROUND
    page = Image.new(mode, extent, paper)
    draw = ImageDraw.Draw(page)
    for i, name in enumerate(names):
        x, y = GAP + i % COLUMNS * (width + GAP), GAP + i // COLUMNS * row
        draw_caption(draw, (x, y), name, captions[name], width, text, inks)
        shown = tone(rendering.pictures[name], brightest)
        page.paste(tile(displayed(shown), zoom), (x, y + caption))
        y += caption + height + GAP
        if name in differences:
            page.paste(tile(_false_colour(differences[name]), zoom), (x, y))
            draw.rectangle((x, y, x + width - 1, y + height - 1), outline=(200, 200, 200))
        elif differences:
            _draw_legend(page, draw, (x, y, width, height), text, inks)
    return page


def tile(rgb, zoom):
    """A `PIL.Image` of values (height, width, 3) in 0..1, each pixel `zoom` × `zoom` large."""
    from PIL import Image

    image = Image.fromarray((np.clip(rgb, 0, 1) * 255 + 0.5).astype(np.uint8))
    return image.resize((image.width * zoom, image.height * zoom), Image.Resampling.NEAREST)


def displayed(linear):
    """sRGB in 0..1 of linear values; magenta, which stands out, where they are not finite."""
    finite = np.isfinite(linear).all(axis=-1, keepdims=True)
    return np.where(finite, to_srgb(linear), (1, 0, 1))


def colour_differences(rendering):
    """ΔE2000 to the reference (height, width), by the name of every other picture."""
    pictures = rendering.pictures
    reference = pictures[rendering.reference]
    return {n: ciede2000(reference, pictures[n]) for n in rendering.differences}


def _false_colour(difference):
    """sRGB (height, width, 3) in 0..1 of differences ΔE (height, width)."""
    import matplotlib as mpl

    colours = mpl.colormaps["magma"].with_extremes(bad="magenta")  # not finite: as in `displayed`
    return colours(difference / MOST)[..., :3]


def _font(size, bold=False):
    import matplotlib as mpl
    from PIL import ImageFont

    file = f"fonts/ttf/DejaVuSans{'-Bold' if bold else ''}.ttf"  # comes with matplotlib
    return ImageFont.truetype(str(Path(mpl.get_data_path(), file)), size)


def draw_caption(draw, corner, name, below, width, size, inks):
    """Draw the name, shortened in its middle where it is too long, and the line `below` it."""
    x, y = corner
    bold = _font(size, bold=True)
    shown = name = to_printable(name)  # Pillow cannot measure several lines
    keep = len(name)
    while bold.getlength(shown) > width and keep > 2:
        keep -= 1
        shown = f"{name[: ceil(keep / 2)]}…{name[-(keep // 2) :]}"
    draw.text((x, y), shown, inks[0], bold)
    draw.text((x, y + round(1.4 * size)), below, inks[1], _font(size))


def _draw_legend(page, draw, box, size, inks):
    """Draw the scale of the false colours, in the empty place below the reference."""
    x, y, width, height = box
    font, small = _font(size), _font(round(0.85 * size))
    middle = y + height // 2
    draw.text((x, middle - 3 * size), "difference in colour ΔE", inks[0], font)
    draw.text((x, middle - round(1.6 * size)), "CIEDE2000; 1 is just seen", inks[1], small)
    bar = np.broadcast_to(np.linspace(0, MOST, width), (size, width))
    page.paste(tile(_false_colour(bar), 1), (x, middle))
    draw.rectangle((x, middle, x + width - 1, middle + size - 1), outline=(200, 200, 200))
    below = middle + round(1.35 * size)
    for place, anchor, label in (
        (0, "la", "0"),
        (width / 2, "ma", f"{MOST / 2:g}"),
        (width, "ra", f"{MOST} and more"),
    ):
        draw.text((x + place, below), label, inks[0], small, anchor=anchor)
