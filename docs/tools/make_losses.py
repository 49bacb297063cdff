"""Makes `docs/losses.md` and its figure: which loss gives the best pictures, path-traced.

    BRDFKIT_DATA=FOLDER python docs/tools/make_losses.py --cache CACHE  # half an hour

FOLDER contains third-party measurements: neural reconstructions of MERL's materials. Every fifth of
them is fitted by each loss, and rendered with its fits until the noise is below a floor. CACHE
stores each fit and the errors of its picture, so that the same command continues an interrupted
run. The page is written again after each loss; its text is in `losses_page.py`.
"""

import sys

from losses_page import write_page
from make_leaderboard import (
    SEED,
    SHAPE,
    ResultCache,
    make_reconstructions,
    read_arguments,
    run_sweep,
)

import brdfkit as bk

MODELS = "ggx", "abc", "ggx+ggx", "abc+student_t"
# The losses that are compared, the most important first
LOSSES = "cbrt", "log", "picture", "cosine"
# One of this many materials is fitted
EVERY = 5
SIZE, UNTIL = 64, 45.0  # side of the pictures [pixels], and their noise floor [dB]


def compute_picture_errors(file, fits, kept):
    """Return the errors of the pictures of `fits` to the material in `file`, and of the noise."""
    truth = bk.load(file)

    def render_errors():
        """Render the material and its fits, and return the errors of the pictures."""
        errors = bk.render([truth, *fits], noise_floor=UNTIL, size=SIZE, seed=SEED).errors()
        return {"errors": list(errors.by_name.values()), "floor": errors.floor}

    key = "/".join([truth.name, *(f"{fit.name}:{fit.loss_name}:{fit.loss:.9g}" for fit in fits)])
    found = kept(key, render_errors)
    kept.write()
    return found


def main():
    """Make all fits and pictures that the cache does not contain, and write the page."""
    given, _, networks = read_arguments(__doc__)
    kept = ResultCache(given.cache / "pictures.json")
    files = make_reconstructions(networks, given.cache, SHAPE, sorted(networks)[::EVERY])

    rows = []
    for loss in LOSSES:
        found = run_sweep(files, MODELS, loss, given.cache / loss, given).rows
        for number, file in enumerate(files, 1):
            fits = [row.fit for row in found if row.material == file.stem and row.fit]
            looks = compute_picture_errors(file, fits, kept)
            print(f"{loss}: {number} of {len(files)} materials", end="\r", file=sys.stderr)
            for fit, errors in zip(fits, looks["errors"], strict=True):
                about = {"material": file.stem, "model": fit.name, "loss": loss}
                rows.append({**about, **errors, "floor": looks["floor"]["psnr"]})
        write_page(rows, UNTIL, SIZE)
    return 0


if __name__ == "__main__":
    sys.exit(main())
