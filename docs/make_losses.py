"""Makes `docs/losses.md` and its pictures: which loss looks best, by path-traced pictures.

    BRDFKIT_DATA=FOLDER python docs/make_losses.py --cache CACHE    # hours on two cores

FOLDER holds third-party measurements: neural reconstructions of MERL's materials. Each is fitted by
every loss, and rendered beside its fits until the noise is as small as is asked for. CACHE keeps
each fit and the figures of each picture, and the same command goes on from there; the page is
written again after each loss. Its words are in `losses_page.py`.
"""

import argparse
import os
import sys
from pathlib import Path

import numpy as np
from losses_page import write_page
from make_leaderboard import NETWORKS, SEED, SHAPE, Kept, reconstructions

import brdfkit as bk

MODELS = "ggx", "abc", "ggx+ggx", "abc+student_t"
# The losses, those that matter most first
LOSSES = "log", "cbrt", "picture", "cosine", "relative", "lafortune", "plain"
SIZE, UNTIL = 64, 45.0  # of pictures [pixels], and their noise floor [dB]


def fit_all(files, loss, output, workers):
    """The rows of a finished sweep, each fit of which is kept in `output`."""
    found = bk.sweep(files, MODELS, {"loss": loss}, output=output, workers=workers)
    print(f"{output.name}: {found.summary}", *found.problems, sep="\n", file=sys.stderr)
    if len(found.rows) < found.asked:
        sys.exit("interrupted; the same command goes on from there.")
    return found.rows


def judge(file, fits, kept):
    """The errors of pictures of the `fits` to the material in `file`, and their noise floor."""
    truth = bk.load(file)

    def look():
        errors = bk.render([truth, *fits], until=UNTIL, size=SIZE, seed=SEED).errors()
        return {"errors": list(errors.by_name.values()), "floor": errors.floor}

    key = "/".join([truth.name, *(f"{fit.name}:{fit.loss_name}:{fit.loss:.9g}" for fit in fits)])
    found = kept(key, look)
    kept.write()
    return found


def main():
    """Fit what is not fitted, render what is not rendered, and write the page."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--cache", type=Path, required=True, help="folder for the fits")
    parser.add_argument("--workers", type=int, help="processes; default: one for each core")
    given = parser.parse_args()
    folder = os.environ.get("BRDFKIT_DATA")
    if not folder:
        sys.exit("BRDFKIT_DATA names no folder of measurements")
    with np.load(Path(folder) / NETWORKS) as read:
        networks = dict(read)
    kept = Kept(given.cache / "pictures.json")
    files = reconstructions(networks, given.cache, SHAPE)

    rows = []
    for loss in LOSSES:
        found = fit_all(files, loss, given.cache / loss, given.workers)
        for number, file in enumerate(files, 1):
            fits = [row.fit for row in found if row.material == file.stem and row.fit]
            looks = judge(file, fits, kept)
            print(f"{loss}: {number} of {len(files)} materials", end="\r", file=sys.stderr)
            for fit, errors in zip(fits, looks["errors"], strict=True):
                about = {"material": file.stem, "model": fit.name, "loss": loss}
                rows.append({**about, **errors, "floor": looks["floor"]["psnr"]})
        write_page(rows, UNTIL, SIZE)
    return 0


if __name__ == "__main__":
    sys.exit(main())
