"""Writes the files of a rendering: an OpenEXR with all its data, and a montage of its pictures."""

from __future__ import annotations

import json
from functools import cache
from importlib.util import find_spec
from math import ceil, isfinite
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from brdfkit.core.array_types import AnyArray, FloatArray
from brdfkit.core.colours import to_srgb
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.json_values import to_json
from brdfkit.core.names import to_printable
from brdfkit.core.version import __version__
from brdfkit.images.errors.colour_difference import ciede2000
from brdfkit.images.hatching import hatch

if TYPE_CHECKING:
    from PIL.Image import Image as PillowImage

COLUMNS = 4  # largest number of pictures in a row of a montage
TILE = 320  # smallest width of a picture [pixels]; narrower ones are enlarged, so captions fit
GAP = 20  # space around each picture [pixels]
# A page's mode in Pillow, and the colours of its ground, of names, and of the text below names
WHITE_GROUND = "RGB", (255, 255, 255), (26, 26, 26), (105, 105, 105)
# Mode and colours of a page in notebooks: transparent, with grey text, readable on white and black
ANY_GROUND = "RGBA", (125, 125, 125, 0), (125, 125, 125, 255), (125, 125, 125, 255)
HATCHES = "stripes: inferred; dense: guessed"  # below a picture that is hatched
LARGEST_DIFFERENCE = 20  # colour difference ΔE of the brightest false colour, in all montages


def find_picture_suffix(path: Path) -> str:
    """Return the suffix of a path, ".exr" or ".png"; raise `BrdfkitError` for any other."""
    suffix = path.suffix.lower()
    if suffix not in (".exr", ".png"):
        raise BrdfkitError(f"{path}: pictures are written as .exr or .png; choose one of them.")
    return suffix


def write_exr(rendering: Any, path: Path) -> None:
    """Write each picture, difference and standard error of a `Rendering` as a part of an EXR."""
    import OpenEXR

    parts = []
    # For each part of the file, by title: the name of the picture to which it belongs, its values
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
    except RuntimeError as error:  # raised by OpenEXR, for example if the disk is full
        raise OSError(str(error)) from error


def draw_montage(rendering: Any, on_any_ground: bool = False) -> PillowImage:
    """Draw the pictures of a `Rendering` with captions, up to four in a row.

    The page is white or, with `on_any_ground`, transparent for notebooks. Below each picture is its
    colour difference from the reference (CIEDE2000), in false colours that a legend explains. At
    the end, pictures of completed materials are repeated, hatched where nothing was measured.
    """
    from PIL import Image, ImageDraw

    captions, differences = rendering.captions, compute_colour_differences(rendering)
    tone = rendering.tone_mapping
    brightest = tone.brightest_of(rendering.pictures[rendering.reference])
    names = [*rendering.pictures, *rendering.evidence]

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
        repeated = i >= len(rendering.pictures)
        below = HATCHES if repeated else captions[name]
        draw_caption(draw, (x, y), name, below, width, text, inks)
        shown = to_image(to_visible_srgb(tone(rendering.pictures[name], brightest)), zoom)
        if repeated:
            shown = hatch_image(shown, rendering.evidence[name], zoom)
        page.paste(shown, (x, y + caption))
        y += caption + height + GAP
        if repeated:
            continue
        if name in differences:
            page.paste(to_image(_to_false_colours(differences[name]), zoom), (x, y))
            draw.rectangle((x, y, x + width - 1, y + height - 1), outline=(200, 200, 200))
        elif differences:
            _draw_legend(page, draw, (x, y, width, height), text, inks)
    return page


def draw_picture(rendering: Any) -> PillowImage:
    """Draw the first picture of a `Rendering`, and nothing else."""
    picture = rendering.pictures[rendering.reference]
    return to_image(to_visible_srgb(rendering.tone_mapping(picture)), 1)


def to_image(rgb: FloatArray, zoom: int) -> PillowImage:
    """Convert sRGB values (height, width, 3) in 0..1 to an image, enlarged by the factor `zoom`."""
    from PIL import Image

    image = Image.fromarray((np.clip(rgb, 0, 1) * 255 + 0.5).astype(np.uint8))
    return image.resize((image.width * zoom, image.height * zoom), Image.Resampling.NEAREST)


def hatch_image(image: PillowImage, levels: AnyArray, zoom: int) -> PillowImage:
    """Hatch an image where `levels` (height, width), before it was enlarged by `zoom`, say so."""
    from PIL import Image

    large = levels.repeat(zoom, axis=0).repeat(zoom, axis=1)
    return Image.fromarray(hatch(np.asarray(image), large))


def to_visible_srgb(linear: FloatArray) -> FloatArray:
    """Convert linear values (height, width, 3) to sRGB in 0..1, and make faulty pixels visible.

    Pixels that are not finite become magenta.
    """
    finite = np.isfinite(linear).all(axis=-1, keepdims=True)
    return np.where(finite, to_srgb(linear), (1, 0, 1))


def compute_colour_differences(rendering: Any) -> dict[str, FloatArray]:
    """Return the colour difference ΔE2000 of each picture but the reference from the reference.

    The differences (height, width) are by the names of the pictures of the `Rendering`.
    """
    pictures = rendering.pictures
    reference = pictures[rendering.reference]
    return {n: ciede2000(reference, pictures[n]) for n in rendering.differences}


def _to_false_colours(difference: FloatArray) -> AnyArray:
    """Return sRGB values (height, width, 3) in 0..1 for colour differences (height, width)."""
    import matplotlib as mpl

    colours = mpl.colormaps["magma"].with_extremes(bad="magenta")  # for differences that are NaN
    return colours(difference / LARGEST_DIFFERENCE)[..., :3]


def _load_font(size: int, bold: bool = False) -> Any:
    """Load the font DejaVu Sans of a `size` [pixels]."""
    from PIL import ImageFont

    file = f"DejaVuSans{'-Bold' if bold else ''}.ttf"
    return ImageFont.truetype(str(_find_fonts() / file), size)


@cache
def _find_fonts() -> Path:
    """Return the folder of the fonts in matplotlib's package, whose import would take long."""
    package: Any = find_spec("matplotlib")
    return Path(package.origin).parent / "mpl-data" / "fonts" / "ttf"


def draw_caption(
    draw: Any,
    corner: tuple[int, int],
    name: str,
    below: str,
    width: int,
    size: int,
    inks: list[Any],
) -> None:
    """Draw the name of a picture, and the line of text `below` the name, at a `corner` (x, y).

    A name wider than `width` [pixels] is shortened in its middle. `size` is the size of the font
    [pixels]; `inks` are the colours of the name and of the line.
    """
    x, y = corner
    bold = _load_font(size, bold=True)
    shown = name = to_printable(name)  # without line breaks, which Pillow cannot measure
    keep = len(name)
    while bold.getlength(shown) > width and keep > 2:
        keep -= 1
        shown = f"{name[: ceil(keep / 2)]}…{name[-(keep // 2) :]}"
    draw.text((x, y), shown, inks[0], bold)
    draw.text((x, y + round(1.4 * size)), below, inks[1], _load_font(size))


def _draw_legend(
    page: PillowImage, draw: Any, box: tuple[int, int, int, int], size: int, inks: list[Any]
) -> None:
    """Draw the scale of the false colours in the empty place below the reference.

    `box` is (x, y, width, height), `size` the size of the font, all in pixels, and `inks` are the
    colours of the title and of the text.
    """
    x, y, width, height = box
    font, small = _load_font(size), _load_font(round(0.85 * size))
    middle = y + height // 2
    draw.text((x, middle - 3 * size), "difference in colour ΔE", inks[0], font)
    draw.text((x, middle - round(1.6 * size)), "CIEDE2000; 1 is just seen", inks[1], small)
    bar = np.broadcast_to(np.linspace(0, LARGEST_DIFFERENCE, width), (size, width))
    page.paste(to_image(_to_false_colours(bar), 1), (x, middle))
    draw.rectangle((x, middle, x + width - 1, middle + size - 1), outline=(200, 200, 200))
    below = middle + round(1.35 * size)
    for place, anchor, label in (
        (0, "la", "0"),
        (width / 2, "ma", f"{LARGEST_DIFFERENCE / 2:g}"),
        (width, "ra", f"{LARGEST_DIFFERENCE} and more"),
    ):
        draw.text((x + place, below), label, inks[0], small, anchor=anchor)
