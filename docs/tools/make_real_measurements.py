"""Makes `docs/real_measurements.md`, its figures and its picture.

    BRDFKIT_DATA=FOLDER python docs/tools/make_real_measurements.py [FILE...]  # minutes

The page shows fits of files as instruments give them, and fits of one material in five kinds of
files. FOLDER contains third-party measurements, which brdfkit does not ship. Results are stored in
`real_measurements.json`, so that the same command continues an interrupted run. Files and materials
that are named are measured again, and nothing else. `--only files`, `invariance`, `balls` or `page`
makes one part. To measure everything again, delete the JSON.

`real_measurements/errors.py` computes the errors for files; `real_measurements/files.py` writes the
five files, and `real_measurements/invariance.py` compares their fits; the text is in
`real_measurements/page.py`.
"""

import argparse
import json
import os
import sys
import tempfile
import time
from concurrent.futures import ProcessPoolExecutor, as_completed
from multiprocessing import get_context
from pathlib import Path

import numpy as np
from brdfkit.theses.kurt2007.neural import decode_network
from PIL import Image, ImageDraw, ImageFont
from real_measurements import page
from real_measurements.errors import MODELS, measure_fits
from real_measurements.files import FILES, save_and_load
from real_measurements.invariance import LOSSES, Part, compare_files

import brdfkit as bk
from brdfkit.core import catalogue
from brdfkit.core.colours import to_srgb
from brdfkit.core.files import write_safely
from brdfkit.core.jit.threads import set_thread_count
from brdfkit.core.json_values import round_numbers

RESULTS = Path(__file__).parents[1] / "real_measurements.json"
DIGITS = 4  # significant digits of the numbers in the JSON
# Files of measurements in the folder, and the samples of CUReT's file that are used
COLLECTIONS = "rgl/*.bsdf", "minidiff_paints/*.astm.xz", "cornell/*.[ab]*", "alta_retro/*.dat.xz"
CURET = "curet/abrdf.dat", range(1, 61, 10)
# Neural reconstructions that are written as five kinds of files, like brdfkit's isotropic tables
NETWORKS = "nbrdf_derived/merl_nbrdf.npz"
RECONSTRUCTIONS = "nickel", "red-fabric", "specular-blue-phenolic", "white-paint"
SHAPE = 90, 45, 90
# Files that the picture shows
SHOWN = (
    "rgl/satin_rosaline_rgb.bsdf",
    "rgl/cc_iris_purple_gem_rgb.bsdf",
    "rgl/acrylic_felt_green_rgb.bsdf",
    "minidiff_paints/C2_Black.astm.xz",
    "minidiff_paints/C8_Silver.astm.xz",
    "cornell/cayman.brdf",
    "alta_retro/retro-gray-tape.dat.xz",
    "curet/abrdf.dat#21",
)
BALLS = "ggx", "ggx+ggx"
SIZE, SPP, CAPTION, FONT, COLUMNS = 150, 256, 20, 12, 2


def list_measurements(folder):
    """Return the paths of the measured files, relative to the folder."""
    found = [str(p.relative_to(folder)) for c in COLLECTIONS for p in sorted(folder.glob(c))]
    file, numbers = CURET
    return found + [f"{file}#{number}" for number in numbers if (folder / file).is_file()]


def list_materials(folder):
    """Return the names of the materials that are written as five kinds of files."""
    own = [name for name in catalogue.list_materials() if not bk.load(name).anisotropic]
    return own + list(RECONSTRUCTIONS) * (folder / NETWORKS).is_file()


def make_table_of(name, folder):
    """Return a material as a table with half as many cells as MERL's along θ_d and φ_d."""
    if name not in RECONSTRUCTIONS:
        return bk.Measured.from_table(bk.load(name).resampled(SHAPE).values, name=name)
    with np.load(folder / NETWORKS) as networks:
        table = decode_network(networks[name].astype(float), SHAPE)
    return bk.Measured.from_table(table.values, name=name)


def measure_file(name, folder):
    """Return the errors of fits to one measured file."""
    set_thread_count(1)
    return measure_fits(bk.load(str(folder / name)))


def measure_invariance(name, folder):
    """Return how the fits of one material differ between files, by model and loss."""
    set_thread_count(1)
    table = make_table_of(name, folder)
    with tempfile.TemporaryDirectory() as beside:
        files = {kind: save_and_load(kind, table, Path(beside)) for kind in FILES}
    part = Part(files["table"])
    return {
        model: {loss: compare_files(files, model, loss, part) for loss in LOSSES}
        for model in MODELS
    }


def run_missing(part, folder, results, given):
    """Measure the names on the command line, or else all that have no results, in processes.

    `part`: a key of `WORK`; `results`: results of all parts, which are stored after each name;
    `given`: arguments of the command line.
    """
    work, list_names = WORK[part]
    found, names = results.setdefault(part, {}), list_names(folder)
    missing = [n for n in names if (n in given.names if given.names else n not in found)]
    began, done = time.perf_counter(), 0
    with ProcessPoolExecutor(given.workers, get_context("spawn")) as pool:
        futures = {pool.submit(work, name, folder): name for name in missing}
        for future in as_completed(futures):
            found[futures[future]] = round_numbers(future.result(), DIGITS)
            results[part] = {name: found[name] for name in names if name in found}
            write_results(results)
            done += 1
            seconds = time.perf_counter() - began
            print(
                f"{part}: {done} of {len(missing)}, {seconds:.0f} s, {futures[future]}", flush=True
            )


def write_results(results):
    """Write the results to the JSON file, with a line for each name."""
    parts = []
    for part, found in results.items():
        lines = [f"{json.dumps(k)}: {json.dumps(v, ensure_ascii=False)}" for k, v in found.items()]
        parts.append(f"{json.dumps(part)}: {{\n" + ",\n".join(lines) + "\n}")
    with write_safely(RESULTS) as beside:
        beside.write_text("{\n" + ",\n".join(parts) + "\n}\n", encoding="utf-8")


def draw_balls(folder):
    """Return an image with balls of some measured files, each next to balls of its fits."""
    shown = [name for name in SHOWN if (folder / name.partition("#")[0]).is_file()]
    width, height = SIZE * (1 + len(BALLS)), SIZE + CAPTION
    rows = -(-len(shown) // COLUMNS)
    sheet = Image.new("RGB", (COLUMNS * (width + CAPTION), rows * height), "white")
    draw, font = ImageDraw.Draw(sheet), ImageFont.load_default(FONT)
    for k, name in enumerate(shown):
        data = bk.load(str(folder / name))
        fits = [bk.fit(data, model) for model in BALLS]
        pictures = bk.render([data, *fits], spp=SPP, size=SIZE).pictures.values()
        left, top = k % COLUMNS * (width + CAPTION), k // COLUMNS * height
        for column, (title, picture) in enumerate(zip((data.name, *BALLS), pictures, strict=True)):
            image = Image.fromarray((to_srgb(picture) * 255 + 0.5).astype(np.uint8))
            at = left + column * SIZE
            sheet.paste(image, (at, top + CAPTION))
            draw.text((at + 3, top + CAPTION // 2), title, "black", font, anchor="lm")
        print(f"balls: {k + 1} of {len(shown)}", flush=True)
    return sheet


WORK = {
    "files": (measure_file, list_measurements),
    "invariance": (measure_invariance, list_materials),
}


def main():
    """Measure the parts that the command line asks for, and write the page."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("names", nargs="*", help="files and materials that are measured anew")
    parser.add_argument("--only", choices=(*WORK, "balls", "page"), help="one part; default: all")
    parser.add_argument("--workers", type=int, default=2, help="processes")
    given = parser.parse_args()
    folder = os.environ.get("BRDFKIT_DATA")
    if not folder:
        sys.exit("BRDFKIT_DATA names no folder of measurements")
    folder = Path(folder)
    results = json.loads(RESULTS.read_text(encoding="utf-8")) if RESULTS.is_file() else {}
    for part in WORK:
        if given.only in (part, None):
            run_missing(part, folder, results, given)
    if given.only in ("balls", None) and not given.names:
        draw_balls(folder).save(page.PAGE.with_suffix(".jpg"), quality=90)
    page.write_page(results)
    return 0


if __name__ == "__main__":
    sys.exit(main())
