"""Makes `docs/materials/`: a page of each material that comes with brdfkit, with fits and balls.

It also makes `docs/materials.jpg`, a picture of all materials for the README.

python docs/tools/make_materials.py           # five minutes
python docs/tools/make_materials.py plaster   # one of them
"""

import sys
from pathlib import Path

import numpy as np
from make_models import join_paragraphs, make_table
from PIL import Image, ImageDraw, ImageFont

import brdfkit as bk
from brdfkit.core import catalogue
from brdfkit.regression.losses.named_losses import DEFAULT

FOLDER = Path(__file__).parents[1] / "materials"
MODELS = ("ward", "ggx", "ggx+ggx", "abc+student_t")
SIZE, SPP = 224, 144
BALL, LINE = 160, 28  # size of a ball and height of a label in the montage [pixels]
INDEX = """They come with brdfkit, are free to use, and are found by their names, as by
`bk.load("car_paint")` or `brdfkit fit car_paint -m ggx`. None of them is one of brdfkit's models,
so every fit has something to miss. [How they were made](../../data/measured/README.md)."""
FITS = """## Four fits

Each by `bk.fit("{name}", model)`, with the default loss, cbrt. *Error*: what the fit made small;
*PSNR*: of the fit's ball against the measured one, {spp} samples per pixel. The picture shows
`{best}`, which has the least error."""
AGAIN = """    brdfkit info {name}
    brdfkit fit {name} -m {best} --render -o {name}"""


def make_index():
    """Return the text of the page with all materials."""
    rows = [
        (
            f"[{m.title}]({m.name}.md)",
            f"`{m.name}`",
            make_image_tag(m.name, m.name, SIZE // 2),
            m.what,
        )
        for m in catalogue.list_materials().values()
    ]
    return join_paragraphs(
        "# The materials", INDEX, make_table("material, name, measured, what it is", rows)
    )


def make_page_head(material):
    """Return the first lines of a material's page, by its entry in the catalogue."""
    sentence = material.what[0].upper() + material.what[1:] + "."
    made = f"Made by: {material.source}. Licence: {material.licence}."
    return join_paragraphs(f"# {material.title}", sentence, f"`{material.name}`. {made}")


def make_image_tag(name, alt, width):
    return f'<img src="{name}.jpg" width="{width}" alt="A ball of {alt}">'


def write_material(material):
    """Write the page of a material, and pictures of the measured and the best fitted ball."""
    measured = bk.load(material.name)
    fits = {name: bk.fit(measured, name) for name in MODELS}
    rendering = bk.render([measured, *fits.items()], spp=SPP, size=SIZE)
    psnr, errors = rendering.psnr(), bk.compare(measured, fits.values()).errors
    error = {name: errors[fit.name][DEFAULT] for name, fit in fits.items()}
    best = min(error, key=error.get)
    write_jpeg(rendering.pictures[rendering.reference], FOLDER / f"{material.name}.jpg")
    write_jpeg(rendering.pictures[best], FOLDER / f"{material.name}_fit.jpg")
    shown = [
        make_image_tag(material.name, material.name, SIZE),
        make_image_tag(f"{material.name}_fit", best, SIZE),
    ]
    rows = [(f"`{name}`", f"{error[name]:.4f}", f"{psnr[name]:.1f} dB") for name in MODELS]
    text = join_paragraphs(
        make_page_head(material).rstrip(),
        make_table(f"measured, fitted by `{best}`", [shown]),
        FITS.format(name=material.name, best=best, spp=SPP),
        make_table("model, error, PSNR", rows),
        AGAIN.format(name=material.name, best=best),
        "[All materials](README.md)",
    )
    (FOLDER / f"{material.name}.md").write_text(text, encoding="utf-8")


def write_jpeg(linear, path):
    """Write a picture of linear light as a JPEG in sRGB."""
    import mitsuba as mi

    bitmap = np.array(mi.util.convert_to_bitmap(linear))
    Image.fromarray(bitmap).save(path, quality=88, optimize=True)


def write_montage():
    """Write a picture of all materials, with measured balls above those of the fits."""
    names, font = list(catalogue.list_materials()), ImageFont.load_default(BALL // 8)
    sheet = Image.new("RGB", (BALL * len(names), 2 * BALL + 3 * LINE), "white")
    draw = ImageDraw.Draw(sheet)
    for row, (suffix, word) in enumerate({"": "measured", "_fit": "fitted"}.items()):
        top = row * (BALL + LINE)
        draw.text((4, top + LINE // 2), word, "black", font, anchor="lm")
        for column, name in enumerate(names):
            ball = Image.open(FOLDER / f"{name}{suffix}.jpg").resize((BALL, BALL))
            sheet.paste(ball, (column * BALL, top + LINE))
    for column, name in enumerate(names):
        middle = column * BALL + BALL // 2, 2 * BALL + 2 * LINE + LINE // 2
        draw.text(middle, name.replace("_", " "), "black", font, anchor="mm")
    sheet.save(FOLDER.with_suffix(".jpg"), quality=88, optimize=True)


if __name__ == "__main__":
    FOLDER.mkdir(exist_ok=True)
    (FOLDER / "README.md").write_text(make_index(), encoding="utf-8")
    for name in sys.argv[1:] or catalogue.list_materials():
        write_material(catalogue.list_materials()[name])
        print(name, flush=True)
    write_montage()
