"""Makes `docs/measured.md`: every available measurement, audited and rendered on a ball.

    BRDFKIT_DATA=FOLDER python docs/tools/make_measured.py [FILE...]    # six seconds a material

FOLDER contains third-party files, which brdfkit does not ship; its own materials come first.
"""

import math
import os
import sys
import textwrap
import time
from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw, ImageFont

import brdfkit as bk
from brdfkit.checks.material_subject import Subject
from brdfkit.checks.sampling import compute_weight_spreads
from brdfkit.core import catalogue
from brdfkit.core.colours import to_srgb
from brdfkit.core.geometry.directions import from_angles
from brdfkit.rendering.scenes.ball import ball

PAGE = Path(__file__).parents[1] / "measured.md"
SIZE, SPP, COLUMNS = 128, 121, 10
CAPTION, FONT, LETTERS = 32, 11, 18  # heights of label and font [pixels], characters in a line
SAMPLES = 200_000
TEXT = """# Measured materials

Every measurement that was at hand when `docs/tools/make_measured.py` ran, looked up and path-traced
in the same light: brdfkit's own, then third-party files, which are shown here and not shipped.
What begins with *neural* is no measurement, but a neural reconstruction of one in MERL's or
Nielsen's collection [Sztrajman et al. 2021].

![A ball of each](measured.jpg)

*std*: standard deviation of the weight of a sample over its mean, at 0, 30, 60, 75 and 85°; RGL's
files (`_rgb`) are sampled by their own luminance, all others by a table of half vectors. *albedo*:
at 0 and 60°, mean of the channels. *open*: seconds from the file to a BSDF. *time*: of a picture,
in units of an analytic Ward's. *doubts*: how many things `brdfkit info` finds to say.

"""


def list_measurements(folder):
    """Return the arguments of `brdfkit.load` for all measurements, names and paths."""
    names = list(catalogue.list_materials())
    for path in sorted(p for p in Path(folder).rglob("*") if p.is_file()):
        suffix = path.name.removesuffix(".xz").rpartition(".")[2]
        if path.name == "abrdf.dat":
            names += [f"{path}#{number}" for number in range(1, 62)]
        elif suffix in ("astm", "brdf", "bsdf", "dat", "binary"):
            names.append(str(path))
    return names


def render_ball(bsdf):
    """Return the linear picture of a ball with a BSDF, and the seconds of its rendering."""
    import mitsuba as mi

    scene = mi.load_dict(ball(bsdf, (SIZE, SIZE), SPP))
    seconds = []
    for seed in range(2):
        began = time.perf_counter()
        picture = np.array(scene.integrator().render(scene, seed=seed, spp=SPP))[..., :3]
        seconds.append(time.perf_counter() - began)
    return picture, min(seconds)


def measure_material(name, ward):
    """Return the name, the row of the table and the picture of a measurement.

    `ward`: the BSDF whose rendering time is the unit.
    """
    began = time.perf_counter()
    measured = bk.load(name)
    material = measured.rgb
    subject = Subject(material)
    bsdf = subject.bsdf
    seconds = time.perf_counter() - began
    stds = " ".join(f"{spread:.2f}" for spread in compute_weight_spreads(subject, SAMPLES))
    albedos = [bk.albedo(material, from_angles(np.radians(d), 0.0)).mean() for d in (0, 60)]
    picture, took = render_ball(bsdf)
    _, unit = render_ball(ward)  # measured again, because the load of the machine may change
    kind = "table" if measured.is_table else "samples"
    doubts = len(bk.audit(measured).findings())
    cells = measured.name, kind, len(measured.channels), len(measured.values), stds
    cells += (" ".join(f"{a:.2f}" for a in albedos), f"{seconds:.1f}", f"{took / unit:.1f}", doubts)
    return measured.name, "| " + " | ".join(map(str, cells)) + " |", picture


def make_sheet(pictures):
    """Return one image of all pictures (by name) with their names."""
    rows = math.ceil(len(pictures) / COLUMNS)
    page = Image.new("RGB", (COLUMNS * SIZE, rows * (SIZE + CAPTION)), "white")
    draw, font = ImageDraw.Draw(page), ImageFont.load_default(FONT)
    for k, (name, picture) in enumerate(pictures.items()):
        x, y = k % COLUMNS * SIZE, k // COLUMNS * (SIZE + CAPTION)
        linear = np.clip(picture, 0, 1)
        page.paste(
            Image.fromarray((to_srgb(linear) * 255 + 0.5).astype(np.uint8)), (x, y + CAPTION)
        )
        draw.text((x + 3, y + 3), wrap_name(name), "black", font)
    return page


def wrap_name(name):
    """Return a name, broken into lines if it is long, because most names differ at their ends."""
    return "\n".join(textwrap.wrap(name, LETTERS))


def main():
    import mitsuba as mi

    folder = os.environ.get("BRDFKIT_DATA")
    if not folder:
        print("BRDFKIT_DATA names no folder of measurements", file=sys.stderr)
        return 2
    mi.set_variant("llvm_ad_rgb")
    ward = bk.models()["ward"]().scene_dict()
    lines, pictures = [], {}
    for name in [*list_measurements(folder), *sys.argv[1:]]:
        title, line, picture = measure_material(name, ward)
        while title in pictures:  # two files may have the same name
            title += "'"
        lines.append(line)
        pictures[title] = picture
        print(line, flush=True)
    heads = [
        "material",
        "kind",
        "channels",
        "values",
        "std",
        "albedo",
        "open [s]",
        "time",
        "doubts",
    ]
    table = ["| " + " | ".join(heads) + " |", "|" + " --- |" * len(heads), *lines]
    make_sheet(pictures).save(PAGE.with_suffix(".jpg"), quality=90)
    PAGE.write_text(TEXT + "\n".join(table) + "\n", encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
