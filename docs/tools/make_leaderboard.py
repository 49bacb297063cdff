"""Makes `docs/leaderboard.md` and its figure: every model, fitted to every available measurement.

    BRDFKIT_DATA=FOLDER python docs/tools/make_leaderboard.py --cache CACHE  # 15 minutes

FOLDER contains third-party measurements. With --scheduler ADDRESS, the workers of a Dask cluster
fit; both folders need the same paths there. CACHE stores each fit as soon as it is finished, so
that the same command continues an interrupted run. The page is written again after each sweep. The
errors are computed by `leaderboard/truth.py`, and the text is in `leaderboard/page.py`.
"""

import argparse
import json
import os
import sys
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from brdfkit.theses.kurt2007.neural import decode_network
from leaderboard.page import write_page
from leaderboard.truth import MAX_ANGLE, PAIRS, Truth

import brdfkit as bk
from brdfkit.cli.cluster import connect_client
from brdfkit.core.files import compute_sha256, write_safely
from brdfkit.materials.measured.selection import select_samples
from brdfkit.model import labels
from brdfkit.regression import regress
from brdfkit.regression.problem.parameter_space import Space
from brdfkit.regression.problem.problem import Problem
from brdfkit.regression.search.levenberg_marquardt import levenberg_marquardt

SEED = 0
# Numbers of cells of the fitted reconstructions, of a MERL table, and of a table for many searches
SHAPE, FULL, COARSE = (60, 30, 60), (90, 90, 180), (30, 24, 48)
FEW = (
    "gold-metallic-paint",
    "chrome-steel",
    "teflon",
    "specular-violet-phenolic",
    "light-brown-fabric",
)
# The main sums of models, which had the least errors of all pairs in trials on a few materials
SUMS = "ggx+ggx", "abc+ggx", "abc+student_t"
# Variants with small errors in the same trials, which are fitted by the log loss only
MORE = (
    "abc+student_t:fresnel=coloured",
    "burley+abc+student_t:fresnel=coloured",
    "ggx:fresnel=coloured",
    "student_t:fresnel=coloured",
)
# Number of random starts with which the search is compared
RESTARTS = 50
# Models that are also fitted to measurements and by other losses, and checked on the materials FEW
SOME = "ggx", "student_t", "ggx+ggx", "abc+student_t"
NETWORKS, MERL = "nbrdf_derived/merl_nbrdf.npz", "neural reconstruction"
COLLECTIONS = {
    "paints": "minidiff_paints/*.astm.xz",
    "RGL": "rgl/*.bsdf",
    "Cornell": "cornell/*.brdf",
}


def list_sweeps():
    """Yield the sweeps (collection, loss, labels of models), the most important first."""
    main = (*(name for name in bk.models() if name != "mixture"), *SUMS)
    yield MERL, "log", main
    yield MERL, "log", MORE
    for collection in COLLECTIONS:
        yield collection, "log", SOME
    yield MERL, "cosine", SOME
    yield MERL, "cbrt", SOME


def make_reconstructions(networks, cache, shape, names=None):
    """Write tables of a `shape` of neural reconstructions to the cache, and return their files."""
    folder = cache / "materials" / "x".join(map(str, shape))
    folder.mkdir(parents=True, exist_ok=True)
    files = [folder / f"{name}.npz" for name in names or sorted(networks)]
    for file in files:
        if not file.is_file():
            table = decode_network(networks[file.stem], shape)
            bk.save(bk.Measured.from_table(table.values, name=file.stem), file)
    return files


def run_sweep(files, models, loss, output, given):
    """Fit some models to some files, and return the finished sweep; `output` stores each fit.

    `given` are the arguments of the command line, with `workers` and `scheduler`.
    """

    def show_progress(done, total):
        """Print the number of finished fits."""
        print(f"{output.name}: {done} of {total} fits", end="\r", file=sys.stderr)

    settings = {"loss": loss, "seed": SEED, "max_angle": MAX_ANGLE}
    with connect_client(given.scheduler) as client:
        where = {"workers": given.workers, "client": client, "folder": output}
        found = bk.sweep(files, models, settings=settings, progress=show_progress, **where)
    print(f"{output.name}: {found.summary}", *found.problems, sep="\n", file=sys.stderr)
    if len(found.rows) < found.requested:
        sys.exit("interrupted; the same command goes on from there.")
    return found


def compare_with_random_starts(file, model):
    """Return the loss of a fit, and the least loss of `RESTARTS` searches from random points."""
    data, model = bk.load(file), labels.model(model)
    samples = select_samples(data, MAX_ANGLE)
    space = Space.for_model(model, {}, model.determine_parameters(samples), data.anisotropic)
    problem = Problem(model, samples, bk.losses.named["log"], space)
    ends = []
    for u in np.random.default_rng(SEED).random((RESTARTS, 1, len(space.names))):
        start = problem.estimate_weights(u)
        found = levenberg_marquardt(
            problem.expand_loss, u, start, problem.weight_limits, 200, 1e-9
        ).ends
        ends.append(float(np.sqrt(found.error[0])))
    # `regress` has no term for the albedo, unlike `bk.fit`, so that the losses are comparable
    return regress(model, samples, bk.losses.named["log"], seed=SEED).loss, min(ends)


class ResultCache:
    """Results in a JSON file by key, so that each is computed only once."""

    def __init__(self, file):
        self.file = file
        self.results = json.loads(file.read_text()) if file.is_file() else {}

    def __call__(self, key, compute, *arguments):
        """Return the result of `key`; compute it by `compute(*arguments)` if it is not there."""
        if key not in self.results:
            self.results[key] = compute(*arguments)
        return self.results[key]

    def write(self):
        """Write the results to the file."""
        with write_safely(self.file) as beside:
            beside.write_text(json.dumps(self.results))


@dataclass(frozen=True)
class Score:
    """The score of a fit; `error`: error in the page's metric, `own`: the loss it minimised."""

    collection: str
    material: str
    model: str
    loss: str
    error: float
    own: float
    parameters: int


def time_fits(file, models, kept):
    """Return the processor seconds of a fit to a file by model, the least of two runs."""
    data = bk.load(file)

    def time_fit(model):
        """Return the least processor seconds of two fits of a model."""
        seconds = []
        for _ in range(2):
            began = time.process_time()
            bk.fit(data, model)
            seconds.append(time.process_time() - began)
        return min(seconds)

    return {model: kept(f"seconds/{file.stem}/{model}", time_fit, model) for model in models}


def compute_scores(rows, collection, networks, kept):
    """Yield the `Score` of every successful fit in the rows of a sweep."""
    asked = {}

    def compute_error(row):
        """Return the error of the fit in a row of the sweep."""
        file = Path(row.file)
        if file not in asked:
            asked.clear()  # keep one in memory, because rows are sorted by file
            asked[file] = Truth(file, networks)
        return asked[file].compute_error(row.fit)

    for row in rows:
        if row.fit:
            key = f"{row.loss}/{row.material}/{row.model}/{compute_sha256(row.saved)}"
            score = row.material, row.model, row.loss, kept(key, compute_error, row), row.error
            yield Score(collection, *score, row.parameters)
    kept.write()


def read_arguments(description):
    """Return the arguments of the command line, the folder of measurements, and its networks.

    `description`: docstring of the program.
    """
    parser = argparse.ArgumentParser(description=description.partition("\n")[0])
    parser.add_argument("--cache", type=Path, required=True, help="folder for the fits")
    parser.add_argument("--workers", type=int, help="processes; default: one for each core")
    parser.add_argument("--scheduler", help="address of a Dask cluster that fits instead")
    given = parser.parse_args()
    folder = os.environ.get("BRDFKIT_DATA")
    if not folder:
        sys.exit("BRDFKIT_DATA names no folder of measurements")
    folder = Path(folder)
    with np.load(folder / NETWORKS) as read:
        networks = dict(read)
    return given, folder, networks


def main():
    """Make all fits that the cache does not contain, compute their errors, and write the page."""
    given, folder, networks = read_arguments(__doc__)
    kept = ResultCache(given.cache / "errors.json")

    files = {MERL: make_reconstructions(networks, given.cache, SHAPE)}
    files |= {name: sorted(folder.glob(pattern)) for name, pattern in COLLECTIONS.items()}
    shape = "×".join(map(str, SHAPE))
    facts = {"merl": MERL, "pairs": PAIRS, "angle": MAX_ANGLE, "seed": SEED, "shape": shape}
    scores, full, restarts, seconds = [], [], [], {}
    timed = next(file for file in files[MERL] if file.stem == FEW[0])
    for collection, loss, models in list_sweeps():
        rows = run_sweep(files[collection], models, loss, given.cache / loss, given).rows
        scores += compute_scores(rows, collection, networks, kept)
        seconds |= time_fits(timed, models, kept)
        write_page(scores, seconds, full, restarts, facts)
    # A few materials in full, and from random starts
    few = make_reconstructions(networks, given.cache, FULL, FEW)
    rows = run_sweep(few, SOME, "log", given.cache / "full", given).rows
    full += compute_scores(rows, MERL, networks, kept)
    for file in make_reconstructions(networks, given.cache, COARSE, FEW):
        for model in SOME:
            found = kept(f"restarts/{file.stem}/{model}", compare_with_random_starts, file, model)
            restarts.append((file.stem, model, *found))
    kept.write()
    write_page(scores, seconds, full, restarts, facts)
    return 0


if __name__ == "__main__":
    sys.exit(main())
