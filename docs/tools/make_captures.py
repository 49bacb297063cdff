"""Makes docs/captures.md, its figures captures.json and its picture captures.jpg.

    BRDFKIT_CAPTURES=FOLDER python docs/tools/make_captures.py    # two minutes

FOLDER holds the public repositories of photographs that `CAPTURES` names, as they are.
"""

import json
import os
from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw, ImageFont

import brdfkit as bk
from brdfkit.core.colours import to_srgb
from brdfkit.core.pages.images import apply_colour_map

DOCS = Path(__file__).parents[1]
PAGE, FIGURES, PICTURE = (DOCS / f"captures.{suffix}" for suffix in ("md", "json", "jpg"))
SERIES = "RafaelMarinheiro+PhotometricStereo/images"
HARVARD = "bchao1+photometric-stereo/data"
CAPTURES = {  # name → its folder, and how its photographs are coded
    "diligent-ball": ("neuralps/data/DiLiGenT/pmsData/ballPNG", None),
    **{
        name: (f"{SERIES}/{name}", "linear")
        for name in ("cat", "owl", "rock", "gray", "horse", "buddha")
    },
    "psbox-cat": ("yxiong+PSBox/data", "linear"),
    "harvard-cat": (f"{HARVARD}/cat", "linear"),
    "harvard-frog": (f"{HARVARD}/frog", "linear"),
}
HOLD_OUT = 4  # every such photograph is held out
HEIGHT, CAPTION, FONT = 150, 22, 13  # pixels of the picture's rows
COLUMNS = "held out", "predicted", "difference", "normals", "diffuse"
LARGEST_DIFFERENCE = 0.3
BEGIN, END = "<!-- {} begin -->", "<!-- {} end -->"


def fit_capture(root, name):
    """Return the maps of a capture below the folder `root`."""
    folder, linearise = CAPTURES[name]
    return bk.photographs.svbrdf(root / folder, linearise=linearise, hold_out=HOLD_OUT)


def measure(maps):
    """Return the figures of a capture."""
    record = maps.record()
    kept = "fitted_errors", "held_out_errors", "lambertian_errors"
    figures = {
        part: {key: value for key, value in record[part].items() if key != "by_name"}
        for part in kept
    }
    return figures | {
        "photographs": len(maps.capture.names),
        "held_out": len(maps.held_out_capture.names),
        "pixels": int(maps.mask.sum()),
        "noise": record["noise"],
        "normal_error": record["normal_error"],
        "lambertian_normal_error": record["lambertian_normal_error"],
        "seconds": round(record["seconds"], 1),
    }


def draw_row(name, maps):
    """Return a row of the picture: a photograph that was held out, and what was found."""
    by_name = maps.held_out_errors.by_name
    chosen = sorted(by_name, key=lambda key: by_name[key][0])[len(by_name) // 2]
    number = maps.held_out_capture.names.index(chosen)
    capture = maps.held_out_capture
    photograph = capture.to_picture(capture.values[number].astype(float))
    predicted = maps.predict(capture.lights.select(np.array([number])))[0]
    white = np.quantile(photograph[maps.mask], 0.99)
    own = np.maximum(photograph.mean(axis=2), 1e-9)
    share = (predicted.mean(axis=2) - own) / own / (2 * LARGEST_DIFFERENCE) + 0.5
    diffuse = maps.maps[next(iter(maps.maps))]
    pictures = [
        to_srgb(photograph / white),
        to_srgb(predicted / white),
        apply_colour_map("RdBu_r", np.where(own > 0.02 * white, share, 0.5))[..., :3],
        (maps.maps["normal"] + 1) / 2,
        to_srgb(diffuse / np.quantile(diffuse[maps.mask], 0.99)),
    ]
    rows, columns = np.nonzero(maps.mask)
    window = slice(rows.min(), rows.max() + 1), slice(columns.min(), columns.max() + 1)
    tiles = []
    for picture in pictures:
        shown = np.where(maps.mask[..., None], np.clip(picture, 0, 1), 0.5)[window]
        image = Image.fromarray((255 * shown + 0.5).astype(np.uint8))
        width = round(image.width * HEIGHT / image.height)
        tiles.append(np.asarray(image.resize((width, HEIGHT), Image.Resampling.LANCZOS)))
    return caption(np.hstack(tiles), f"{name}, {chosen}")


def caption(picture, text):
    """Return a picture with a line of text above it."""
    canvas = Image.new("RGB", (picture.shape[1], CAPTION + picture.shape[0]), "white")
    canvas.paste(Image.fromarray(picture), (0, CAPTION))
    font = ImageFont.load_default(FONT)
    ImageDraw.Draw(canvas).text((2, 3), text, fill="black", font=font)
    return np.asarray(canvas)


def join_rows(rows):
    """Return the rows as one picture in two columns, on white."""
    columns = [rows[: (len(rows) + 1) // 2], rows[(len(rows) + 1) // 2 :]]
    width = max(row.shape[1] for row in rows) + 16
    parts = [
        np.vstack(
            [
                np.pad(row, ((0, 8), (0, width - row.shape[1]), (0, 0)), constant_values=255)
                for row in column
            ]
        )
        for column in columns
    ]
    height = max(part.shape[0] for part in parts)
    return np.hstack(
        [
            np.pad(part, ((0, height - part.shape[0]), (0, 0), (0, 0)), constant_values=255)
            for part in parts
        ]
    )


def write_table(figures):
    """Return the lines of the table of errors."""
    lines = [
        "| object | fitted + held out | errors | adapted | Lambertian | adapted | noise | time |",
        "| --- " * 8 + "|",
    ]
    for name, own in figures.items():
        numbers = [
            f"{100 * own[part][median]:.1f}, {100 * own[part][high]:.1f} %"
            for part in ("held_out_errors", "lambertian_errors")
            for median, high in (("median", "high"), ("adapted_median", "adapted_high"))
        ]
        lines.append(
            f"| `{name}` | {own['photographs']} + {own['held_out']} | {' | '.join(numbers)} "
            f"| {100 * own['noise']:.2g} % | {own['seconds']:.0f} s |"
        )
    return lines


def write_normals(figures):
    """Return the line about normals whose true values are known."""
    own = figures["diligent-ball"]
    return [
        f"The normals of `diligent-ball` are {own['normal_error']:.2f}° off in the mean; those of "
        f"Lambertian photometric stereo {own['lambertian_normal_error']:.2f}°."
    ]


def fill(page, name, lines):
    """Return the page with other lines between two marks."""
    before, _, after = page.partition(BEGIN.format(name))
    return (
        "\n".join([before + BEGIN.format(name), "", *lines, "", END.format(name)])
        + after.partition(END.format(name))[2]
    )


def main():
    root = Path(os.environ["BRDFKIT_CAPTURES"])
    figures, rows = {}, []
    for name in CAPTURES:
        maps = fit_capture(root, name)
        figures[name] = measure(maps)
        rows.append(draw_row(name, maps))
        print(name, figures[name]["held_out_errors"], flush=True)
    FIGURES.write_text(json.dumps(figures, indent=1) + "\n")
    Image.fromarray(join_rows(rows)).save(PICTURE, quality=85)
    page = PAGE.read_text()
    page = fill(page, "errors", write_table(figures))
    PAGE.write_text(fill(page, "normals", write_normals(figures)))


if __name__ == "__main__":
    main()
