"""Makes `docs/losses.md` and its pictures: which loss looks best, by path-traced pictures.

    BRDFKIT_DATA=FOLDER python docs/tools/make_losses.py --cache CACHE  # half an hour

FOLDER holds third-party measurements: neural reconstructions of MERL's materials. Every fifth of
them is fitted by every loss, and rendered beside its fits until the noise is as small as is asked
for. CACHE keeps each fit and the figures of each picture, and the same command goes on from there;
the page is written again after each loss. Its words are in `losses_page.py`.
"""

import sys

from losses_page import write_page
from make_leaderboard import SEED, SHAPE, Kept, reconstructions, start, sweep

import brdfkit as bk

MODELS = "ggx", "abc", "ggx+ggx", "abc+student_t"
# The losses, those that matter most first
LOSSES = "cbrt", "log", "picture", "cosine"
# One of so many materials is shown
EVERY = 5
SIZE, UNTIL = 64, 45.0  # of pictures [pixels], and their noise floor [dB]


def judge(file, fits, kept):
    """The errors of pictures of the `fits` to the material in `file`, and their noise floor."""
    truth = bk.load(file)

    def look():
        errors = bk.render([truth, *fits], noise_floor=UNTIL, size=SIZE, seed=SEED).errors()
        return {"errors": list(errors.by_name.values()), "floor": errors.floor}

    key = "/".join([truth.name, *(f"{fit.name}:{fit.loss_name}:{fit.loss:.9g}" for fit in fits)])
    found = kept(key, look)
    kept.write()
    return found


def main():
    """Fit what is not fitted, render what is not rendered, and write the page."""
    given, _, networks = start(__doc__)
    kept = Kept(given.cache / "pictures.json")
    files = reconstructions(networks, given.cache, SHAPE, sorted(networks)[::EVERY])

    rows = []
    for loss in LOSSES:
        found = sweep(files, MODELS, loss, given.cache / loss, given.workers).rows
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
