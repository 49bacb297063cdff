"""Makes `docs/performance.md`, its figures performance.json and its plot: times and memory.

    python docs/tools/make_performance.py [--before FOLDER] [--only fits,memory]    # ten minutes

FOLDER is another version of the repository, such as of `git worktree add FOLDER COMMIT`: its times
are measured in the same run, in turns with those of this version. BRDFKIT_DATA names a folder of
measurements; without it, what needs them is left out. `--only` measures some sections, and takes
the others from the JSON. `make test` and `make quick` are not run here: `--suite-seconds 360` and
`--quick-seconds 40` store what they took. The cases are in `benchmarks/performance/`, the text of
the page is in `performance_page.py`.
"""

import argparse
import json
import os
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

import performance_page as page

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT / "benchmarks"))

from performance import fits, measuring, rows  # noqa: E402

import brdfkit as bk  # noqa: E402
from brdfkit.core.json_values import round_numbers  # noqa: E402

DIGITS = 4  # significant digits in the JSON
TIMES = 5  # of commands, of which the least counts
MESH_CASES = "ray_test", "path", "shadow_map"
VOLUME_CASES = "single_scattering", "volpath", "glow"
LAMP_CASES = "distance_field", "path"
PREPARE = "import mitsuba; mitsuba.set_variant('llvm_ad_rgb', 'scalar_rgb')"


def measure_fits(sources):
    """Yield each row's figures of fits, in one process for each version."""
    with measuring.start_processes(sources) as started:
        for row in rows.FITS:
            if row.case != "fits: CUReT" or "BRDFKIT_DATA" in os.environ:
                beside = {"beside": (started["now"], row.beside)}
                yield row.case, measuring.race(name_entries(started, row.case) | beside)


def measure_memory(sources):
    """Yield each row's memory, in a new process for each figure."""
    for row in rows.MEMORY:
        with measuring.start_processes(sources) as started:
            yield row.case, {name: one.ask(row.case) for name, one in started.items()}


def measure_processes(sources):
    """Yield the CPU seconds of each command, and of imports of NumPy and Mitsuba."""
    with TemporaryDirectory() as folder:
        file, picture = Path(folder) / "made.csv", str(Path(folder) / "ggx.png")
        bk.save(fits.make_samples(fits.FEW), file)
        arguments = {
            "brdfkit: render": ["-m", "brdfkit", "render", "ggx", "--preview", "-o", picture],
            "brdfkit: fit": ["-m", "brdfkit", "fit", str(file), "-m", "ggx"],
        }
        beside = {rows.NUMPY: ["-c", "import numpy"], rows.MITSUBA: ["-c", PREPARE]}
        for row in rows.PROCESSES:
            commands = {name: (source, arguments[row.case]) for name, source in sources.items()}
            commands["beside"] = sources["now"], beside[row.beside]
            yield row.case, measuring.count_cpu_seconds(commands, TIMES)


def measure_tables(sources):
    """Yield the seconds of pictures of measured tables, and of Ward's model beside them."""
    with measuring.start_processes(sources) as started:
        yield rows.TABLES, {name: one.ask(rows.TABLES) for name, one in started.items()}


def measure_samples(sources):
    """Yield the seconds of fits of more and more samples."""
    for count in rows.SAMPLES:
        with measuring.start_processes(sources) as started:
            entries = name_entries(started, f"samples {count}: ggx")
            entries["beside"] = started["now"], f"samples {count}: SciPy"
            yield f"{count}", measuring.race(entries)


def measure_growth(what, counts, cases, **environment):
    """Return a function that yields the figures of all cases for each number of something."""

    def measure(sources):
        with measuring.start_processes({"now": sources["now"]}, **environment) as started:
            for count in counts:
                entries = {case: (started["now"], f"{what} {count}: {case}") for case in cases}
                yield f"{count}", measuring.race(entries)

    return measure


def measure_lamps(sources):
    """Yield the figures of scenes with more and more lamps, which no kernel is stored for."""
    with TemporaryDirectory() as folder:
        yield from measure_growth("lamps", rows.LAMPS, LAMP_CASES, DRJIT_CACHE_DIR=folder)(sources)


def measure_cluster(sources):
    """Yield the table of what tasks send and receive."""
    if (ROOT / "benchmarks" / "cluster.py").exists():
        with measuring.start_processes({"now": sources["now"]}) as started:
            yield rows.TRAFFIC, started["now"].ask(rows.TRAFFIC)


def name_entries(started, case):
    """Return the entries of a race of one case in all versions."""
    return {name: (process, case) for name, process in started.items()}


# By name of a section: the function that yields its rows, and their number
SECTIONS = {
    "fits": (measure_fits, len(rows.FITS)),
    "memory": (measure_memory, len(rows.MEMORY)),
    "processes": (measure_processes, len(rows.PROCESSES)),
    "tables": (measure_tables, 1),
    "samples": (measure_samples, len(rows.SAMPLES)),
    "triangles": (
        measure_growth("triangles", rows.TRIANGLES, MESH_CASES),
        len(rows.TRIANGLES),
    ),
    "voxels": (measure_growth("voxels", rows.VOXELS, VOLUME_CASES), len(rows.VOXELS)),
    "lamps": (measure_lamps, len(rows.LAMPS)),
    "cluster": (measure_cluster, 1),
}


def read_arguments():
    """Return the arguments of the command line."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--before", type=Path, help="folder of another version to compare with")
    parser.add_argument("--only", help=f"sections, with commas: {', '.join(SECTIONS)}; or page")
    parser.add_argument("--suite-seconds", type=float, help="what `make test` took")
    parser.add_argument("--quick-seconds", type=float, help="what `make quick` took")
    given = parser.parse_args()
    given.only = list(SECTIONS) if given.only is None else given.only.split(",")
    unknown = set(given.only) - {*SECTIONS, "page"}
    if unknown:
        parser.error(f"--only {', '.join(sorted(unknown))}: no such section")
    return given


def measure_sections(given, stored):
    """Measure sections, and store their figures as soon as each is done."""
    sources = {}
    if given.before:
        sources["before"] = given.before.resolve() / "src"
        stored["before"] = measuring.read_commit(given.before)
    sources["now"] = ROOT / "src"
    chosen = [name for name in SECTIONS if name in given.only]
    total = sum(SECTIONS[name][1] for name in chosen)
    with bk.progress("performance") as bar:
        done = 0
        for name in chosen:
            found = {}
            for case, told in SECTIONS[name][0](sources):
                found[case] = told
                done += 1
                bar(done, total)
            stored[name] = found
            stored["machine"] = measuring.describe_machine()
            write_figures(stored)


def write_figures(stored):
    """Write the JSON."""
    text = json.dumps(round_numbers(stored, DIGITS), indent=1, ensure_ascii=False)
    page.FIGURES.write_text(text + "\n", encoding="utf-8")


def main():
    """Measure what was asked for, and write the page."""
    given = read_arguments()
    stored = json.loads(page.FIGURES.read_text("utf-8")) if page.FIGURES.exists() else {}
    measure_sections(given, stored)
    for name in ("suite", "quick"):
        if seconds := getattr(given, f"{name}_seconds"):
            stored.setdefault("suite", {})[name] = {"now": {"seconds": seconds}}
    write_figures(stored)
    page.write_page(json.loads(page.FIGURES.read_text("utf-8")))
    return 0


if __name__ == "__main__":
    sys.exit(main())
