"""The rows of docs/performance.md: what is measured, beside what, and how fast it should be."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Row:
    """A row of a table with bars; its measurement is stored by the name of its `case`.

    `what`: the row's words; `bar`: the largest figure that is good; `was`: the figure before the
    work that this page watches, as text; `beside`: the case it is compared with.
    """

    case: str
    what: str
    bar: float
    was: str
    beside: str


SCIPY, FEW_SCIPY = "fits: SciPy", "fits: few, SciPy"
FITS = (
    Row("fits: ward_duer cosine", "`ward_duer`, `cosine`", 0.05, "0.097", SCIPY),
    Row("fits: ggx cosine", "`ggx`, `cosine`", 0.10, "0.174", SCIPY),
    Row("fits: ggx+ggx log", "`ggx+ggx`, `log`", 1.0, "1.8", SCIPY),
    Row("fits: koenderink log", "`koenderink`, `log`", 1.5, "3 to 4.8", SCIPY),
    Row("fits: sgd log", "`sgd`, `log`", 0.8, "1.3", SCIPY),
    Row(
        "fits: koenderink:order=8 plain bisquare",
        "`koenderink:order=8`, `plain`, bisquare",
        *(3.0, "25", SCIPY),
    ),
    Row(
        "fits: pca_polynomial:degree=7 plain bisquare",
        "`pca_polynomial:degree=7`, `plain`, bisquare",
        *(2.0, "2.9", SCIPY),
    ),
    Row("fits: ggx log bisquare", "`ggx`, `log`, bisquare", 1.0, "1.1", SCIPY),
    Row("fits: few", "200 samples, `ggx`, `cbrt`", 0.010, "0.024", FEW_SCIPY),
    Row("fits: CUReT", "364 fits of CUReT", 3.0, "6.8", SCIPY),
)
MEMORY = (
    Row("memory: ggx cosine", "`ggx`, `cosine`", 150, "200 to 330", ""),
    Row("memory: ggx log", "`ggx`, `log`", 150, "200 to 330", ""),
)
NUMPY, MITSUBA = "python: numpy", "python: mitsuba"
PROCESSES = (
    Row("brdfkit: render", "`brdfkit render ggx --preview`", 1.5, "6.3", MITSUBA),
    Row("brdfkit: fit", "`brdfkit fit FILE -m ggx`", 1.0, "1.8", NUMPY),
)
TABLES, TABLES_BAR, TABLES_WERE = "pictures: tables", 1.2, "1.0 to 1.8"
SUITE = (
    Row("suite", "`make test`", 360, "540 to 720", ""),
    Row("quick", "`make quick`", 40, "", ""),
)
SAMPLES = 200, 2000, 20_000, 200_000, 2_000_000
TRIANGLES = 100_000, 1_000_000, 10_000_000
VOXELS = 64, 128, 256, 512  # along each edge
LAMPS = 1, 10, 100
TRAFFIC = "cluster: traffic"
