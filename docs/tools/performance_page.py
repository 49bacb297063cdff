"""Writes the page of `make_performance.py` and its plot, from the figures of its JSON."""

import sys
from pathlib import Path

DOCS = Path(__file__).parents[1]
sys.path.insert(0, str(DOCS.parent / "benchmarks"))

from make_models import join_paragraphs, make_table  # noqa: E402
from performance import growth, rows  # noqa: E402

from brdfkit.theses.drawing import COLOURS, make_figure, style_axes  # noqa: E402

PAGE, FIGURES, PLOT = (DOCS / f"performance.{suffix}" for suffix in ("md", "json", "png"))
INTRODUCTION = """What fits, pictures and the start of a command cost, and how it grows. Made by
`python docs/tools/make_performance.py`: {cpu}, {cores} cores, {memory} GB. Seconds are of this
machine; **ratios** are of one run, in which what is compared takes turns, each in a process of its
own, and the least of several times counts.{before}"""
BEFORE = """ *Before* is the version `{commit}`: `git worktree add FOLDER {commit}`, and
`--before FOLDER`."""
PICTURE = """![Seconds over samples, triangles, voxels and lamps](performance.png)

*How the cost grows; the tables below say of what.*"""
BARS = """*Bar* is what a figure was, and what it should be at most; **bold** figures are
above it."""
FITS = """Seconds of warm fits of a full table, with the resolution of a MERL file, and of smaller
data. *SciPy* is a fit of `ward_duer` by the loss `cosine` in twelve lines of NumPy and SLSQP, which
knows this one model and gives no standard errors: to the same table, or to the same 200 samples."""
MEMORY = """Largest memory [MB] of a process while it fits a full table, above what it held after
all imports and a small fit. The table and its samples are in it."""
PROCESSES = """Seconds of all cores that a new process needs, from its start to its end. Kernels are
stored from an earlier process. *Beside* are a process that imports Mitsuba and sets its variant,
and one that imports NumPy."""
TABLES = """Times of a path-traced picture of measured materials, in units of one of `ward`.
Bar: {was} → {bar}."""
SUITE = """Seconds of the tests, by two processes."""
SAMPLES = """Warm fits of `ggx` by the default loss to noisy values at random directions [s], and
SciPy's fit of `ward_duer` to the same samples. *First* is the first fit in a process, of which the
kernels are found and the extents of the samples are measured."""
TRIANGLES = """A picture of {side}² pixels of hills under a sun. *Rays* are Mitsuba's rays from the
pixels to the sun, [ns] each; the others are pictures with a sample for each pixel, per pixel and in
units of a ray: paths of two edges, and the integrator `shadow_map`, which renders its maps anew.
*Making* is the mesh and Mitsuba's tree over it; *memory* is the largest of the process."""
VOXELS = """A cloud under a sun and a sky, {side}² pixels of {spp} samples, lit once: the integrator
`single_scattering`, and Mitsuba's `volpath`. `emission_absorption` takes as many steps along a ray
as there are voxels along an edge, {glow}² pixels of {glow_spp} samples. *Making* is until the scene
of `single_scattering` is loaded, with its bounds of the extinction."""
LAMPS = """A box on the ground under glowing balls, {side}² pixels of {spp} samples: the integrator
`distance_field`, which adds the light of all lamps, with their soft shadows, and Mitsuba's `path`,
which takes one lamp at random for each sample. *First* is the first picture, of which the kernels
have to be compiled."""
CLUSTER = """What the scheduler of a Dask cluster receives and sends for each task; *tasks/s* and
*MB/s* are those of 100 workers. Measured by `benchmarks/cluster.py`."""


def write_page(stored):
    """Write the page and its plot from the stored figures."""
    PAGE.write_text(make_page(stored), encoding="utf-8")
    draw_growth(stored).savefig(PLOT, dpi=80)


def make_page(stored):
    """Return the text of the page; sections that were not measured are left out."""
    before = BEFORE.format(commit=stored["before"]) if stored.get("before") else ""
    introduction = INTRODUCTION.format(**stored["machine"], before=before)
    parts = ["# Performance", introduction, PICTURE, BARS]
    for name, (title, make) in SECTIONS.items():
        if stored.get(name):
            parts += [f"## {title}", *make(stored[name])]
    return join_paragraphs(*parts)


def make_bars_section(text, listed, beside=None):
    """Return a function that returns a text and the table of rows with bars.

    `beside`: what the rows are compared with, the head of two columns; None without them.
    """

    def make(found):
        head = ["what", "before", "now", "times less", "bar"]
        head += [beside, f"now / {beside}"] if beside else []
        cells = [make_bars_row(row, found[row.case]) for row in listed if row.case in found]
        return text, make_table(", ".join(head), [row[: len(head)] for row in cells])

    return make


def make_bars_row(row, told):
    """Return the cells of a row with a bar."""
    now = read_figure(told.get("now"))
    shown = format_figure(told.get("now"))
    bar = f"{row.was} → {row.bar:g}" if row.was else f"{row.bar:g}"
    return [
        row.what,
        format_figure(told.get("before")),
        f"**{shown}**" if now is not None and now > row.bar else shown,
        format_ratio(told.get("before"), told.get("now")),
        bar,
        format_figure(told.get("beside")),
        format_ratio(told.get("now"), told.get("beside")),
    ]


def read_figure(told, key="seconds"):
    """Return a figure of what a case told, or None where there is none; "MB" for memory."""
    return told.get("MB" if told.get("unit") == "MB" else key) if told else None


def format_figure(told, key="seconds"):
    """Return a figure as text; the error where there is one."""
    if told and "error" in told:
        return told["error"]
    value = read_figure(told, key)
    return "" if value is None else format_number(value)


def format_number(value):
    """Return a number with two significant digits, all digits above 100."""
    return f"{value:.0f}" if value >= 100 else f"{value:#.2g}".rstrip(".")


def format_ratio(one, other):
    """Return the ratio of two figures as text."""
    a, b = read_figure(one), read_figure(other)
    return "" if a is None or not b else format_number(a / b)


def make_tables_section(found):
    """Return the text and the table of pictures of measured tables."""
    by_version = {name: told["by_name"] for name, told in found[rows.TABLES].items()}
    cells = []
    for material in by_version["now"]:
        if material != "ward":
            ratios = [
                times[material] / times["ward"] if material in times else None
                for times in (by_version.get("before", {}), by_version["now"])
            ]
            shown = ["" if r is None else f"{r:.2f}" for r in ratios]
            if ratios[1] > rows.TABLES_BAR:
                shown[1] = f"**{shown[1]}**"
            cells.append((f"`{material}`", *shown))
    text = TABLES.format(was=rows.TABLES_WERE, bar=rows.TABLES_BAR)
    return text, make_table("material, before, now", cells)


def make_samples_section(found):
    """Return the text and the table of fits of more and more samples."""
    cells = []
    for count, told in found.items():
        now = read_figure(told["now"])
        cells.append(
            (
                f"{int(count):,}",
                *(format_figure(told.get(name), "first") for name in ("before", "now")),
                *(format_figure(told.get(name)) for name in ("before", "now")),
                format_ratio(told.get("before"), told["now"]),
                "" if now is None else format_number(1e9 * now / int(count)),
                format_figure(told.get("beside")),
                format_ratio(told["now"], told.get("beside")),
            )
        )
    head = "samples, first before, first now, before, now, times less, now [ns/sample], SciPy"
    return SAMPLES, make_table(f"{head}, now / SciPy", cells)


def make_triangles_section(found):
    """Return the text and the table of meshes."""
    cells = []
    for count, told in found.items():
        rays = told["ray_test"]
        cells.append(
            (
                f"{int(count):,}",
                format_figure(rays, "prepared"),
                format_memory(told["shadow_map"]),
                format_per_pixel(rays, growth.SIDE),
                format_per_pixel(told["path"], growth.SIDE),
                format_ratio(told["path"], rays),
                format_per_pixel(told["shadow_map"], growth.SIDE),
                format_ratio(told["shadow_map"], rays),
            )
        )
    head = "triangles, making [s], memory [GB], ray [ns], `path` [ns], in rays, `shadow_map` [ns]"
    return TRIANGLES.format(side=growth.SIDE), make_table(f"{head}, in rays", cells)


def make_voxels_section(found):
    """Return the text and the table of volumes."""
    cells = []
    for n, told in found.items():
        own = told["single_scattering"]
        cells.append(
            (
                f"{n}³",
                format_figure(own, "prepared"),
                format_memory(told["glow"]),
                format_figure(own),
                format_figure(told["volpath"]),
                format_ratio(own, told["volpath"]),
                format_figure(told["glow"]),
            )
        )
    text = VOXELS.format(
        side=growth.VOLUME_SIDE,
        spp=growth.VOLUME_SPP,
        glow=growth.GLOW_SIDE,
        glow_spp=growth.GLOW_SPP,
    )
    head = "voxels, making [s], memory [GB], `single_scattering` [s], `volpath` [s], ratio"
    return text, make_table(f"{head}, `emission_absorption` [s]", cells)


def make_lamps_section(found):
    """Return the text and the table of lamps."""
    cells = []
    for count, told in found.items():
        shown = [f(told[name]) for name in ("distance_field", "path") for f in FIRST_AND_NEXT]
        ratio = format_ratio(told["distance_field"], told["path"])
        cells.append((f"{count}", *shown, ratio))
    text = LAMPS.format(side=growth.LAMPS_SIDE, spp=growth.LAMPS_SPP)
    head = "lamps, `distance_field` first [s], next [s], `path` first [s], next [s], ratio"
    return text, make_table(head, cells)


def format_first(told):
    """Return the seconds of a first picture, with the compilation of its kernels, as text."""
    if "error" in told:
        return told["error"]
    return format_number(told["seconds"] + told["compiling"])


FIRST_AND_NEXT = format_first, format_figure


def format_per_pixel(told, side):
    """Return the nanoseconds that each pixel of a picture took, as text."""
    value = read_figure(told)
    return format_figure(told) if value is None else format_number(1e9 * value / side**2)


def format_memory(told):
    """Return the largest memory of a process [GB] as text."""
    return "" if "error" in told else format_number(told["MB"] / 1e3)


def make_cluster_section(found):
    """Return the text and the table of what tasks send and receive."""
    told = found[rows.TRAFFIC]["now"] if "now" in found[rows.TRAFFIC] else found[rows.TRAFFIC]
    if "error" in told:
        return (told["error"],)
    head, *cells = told["table"]
    return CLUSTER, make_table(", ".join(head), cells)


SECTIONS = {
    "fits": ("Fits", make_bars_section(FITS, rows.FITS, "SciPy")),
    "memory": ("Memory of a fit", make_bars_section(MEMORY, rows.MEMORY)),
    "processes": ("New processes", make_bars_section(PROCESSES, rows.PROCESSES, "beside")),
    "tables": ("Pictures of tables", make_tables_section),
    "suite": ("Tests", make_bars_section(SUITE, rows.SUITE)),
    "samples": ("More samples", make_samples_section),
    "triangles": ("More triangles", make_triangles_section),
    "voxels": ("More voxels", make_voxels_section),
    "lamps": ("More lamps", make_lamps_section),
    "cluster": ("On a cluster", make_cluster_section),
}
# By section of the plot: its title, what grows, and the curves: their key, label
CURVES = {
    "samples": ("fits", "samples", {"before": "before", "now": "ggx", "beside": "SciPy"}),
    "triangles": (
        "meshes",
        "triangles",
        {"shadow_map": "shadow_map", "path": "path", "ray_test": "rays alone"},
    ),
    "voxels": (
        "volumes",
        "voxels along an edge",
        {
            "volpath": "volpath",
            "single_scattering": "single_scattering",
            "glow": "emission_absorption",
        },
    ),
    "lamps": ("lamps", "lamps", {"path": "path", "distance_field": "distance_field"}),
}


def format_count(n):
    """Return a count in thousands or millions, as text."""
    return f"{n // 10**6} M" if n >= 10**6 else f"{n // 1000} k" if n >= 1000 else f"{n}"


def draw_growth(stored):
    """Return the figure: seconds over samples, triangles, voxels and lamps, both logarithmic."""
    shown = {name: parts for name, parts in CURVES.items() if stored.get(name)}
    figure = make_figure(3.4 * max(len(shown), 1), 3.3)
    for number, (name, (title, what, curves)) in enumerate(shown.items(), 1):
        axes = figure.add_subplot(1, len(shown), number)
        for colour, (key, label) in zip(COLOURS, curves.items(), strict=False):
            points = [(int(n), read_figure(told.get(key))) for n, told in stored[name].items()]
            points = [point for point in points if point[1] is not None]
            if points:
                axes.plot(*zip(*points, strict=True), "o-", ms=4, color=colour, label=label)
        counts = [int(n) for n in stored[name]]
        axes.set_xscale("log")
        axes.set_yscale("log")
        axes.set_xticks(counts, [format_count(n) for n in counts])
        axes.minorticks_off()
        axes.set_xlabel(what)
        style_axes(axes, title, "seconds" if number == 1 else "")
        axes.legend(frameon=False, fontsize=8)
    return figure
