"""A small valid file of each format, for the tests of the formats and for their fuzzing."""

import io
import struct
from functools import cache
from pathlib import Path
from unittest import mock

import numpy as np

from brdfkit.core.errors import BrdfkitError
from brdfkit.core.geometry.directions import from_angles
from brdfkit.materials.formats import Source, list_formats, rgl
from brdfkit.materials.formats.rgl import encoding
from brdfkit.materials.measured import Measured
from brdfkit.model import labels
from brdfkit.model.samples import Samples
from brdfkit.regression.result import Fit

MIRROR_PHI = 3.141593
MERL_SHAPE = (3, 2, 4)
WAVELENGTHS = (450, 550, 650)


def merl(shape=MERL_SHAPE, raw=None, order="<"):
    """A MERL table; `raw` (3, *shape) are the stored values, 1500, 1501, ... unless given."""
    raw = 1500 + np.arange(3 * np.prod(shape)) if raw is None else np.asarray(raw)
    return struct.pack(f"{order}3i", *shape) + raw.astype(f"{order}f8").tobytes()


def cornell(spike=False):
    """Two illuminations, three views each, three wavelengths; the mirror one is brightest."""
    rows = [
        f"{theta:.6f} 0.000000 {view:.6f} {phi:.6f} {value:.6f} {value / 2:.6f} 0.000000"
        for theta in (0.5, 1.0)
        for view, phi, value in ((theta, MIRROR_PHI, 3.0), (theta, 0.0, 0.25), (0.1, 1.5, 0.125))
    ]
    if spike:
        rows.append(f"1.396263 0.000000 1.378810 {MIRROR_PHI} 99.0 98.0 97.0")
    header = ["# A paint", "# High-gloss", "# num wls", "3", "", "# wls", "450 550", "650", ""]
    return "\r\n".join([*header, "# theta i  phi i  theta s  phi_s", *rows, ""]).encode()


def _astm(system, columns, rows):
    keys = [f"SYSTEM_NAME {system}", "SAMPLE_NAME A paint", f"NUM_POINTS {len(rows)}"]
    lines = ["LAB_NAME A laboratory", "", *keys, f"VARS {columns}", ""]
    return "\n".join([*lines, *(",".join(map(str, row)) for row in rows), ""]).encode()


def astm(columns="theta_i,phi_i,theta_s,phi_s,R,G,B"):
    """Cornell's convention: phi_i = 0, a negative value, the mirror direction at 180°."""
    rows = [
        (0.5, 0, 0.5, MIRROR_PHI, 3.0, 2.0, 1.0),
        (0.5, 0, 0.5, 0, -0.01, 0.25, 0.5),
        (1.0, 0, 0.1, 1.5, 0.125, 0.25, 0.5),
    ]
    return _astm("Cornell/Kodak gonioreflectometer", columns, rows)


def mini_diff():
    """Mini-Diff's: phi_i = 180°, no phi_s in VARS, blue first, one row beyond theta_s = 75°."""
    rows = [
        (0.5, np.pi, 0.5, 0, 1.0, 2.0, 3.0),
        (0.5, np.pi, np.radians(75), 0, 0.125, 0.25, 0.5),
        (0.5, np.pi, np.radians(76), 0, 0.0625, 0.125, 0.25),
    ]
    return _astm("Mini-Diff V2", "theta_i,phi_i,theta_s,465nm,525nm,630nm", rows)


def curet(samples=61, geometries=205):
    """`abrdf.dat`, its value number g of sample s being s + g / 1000."""
    rows = ([s, *(f"{s + g / 1000:.3f}" for g in range(geometries))] for s in range(1, samples + 1))
    return "\n".join("   ".join(map(str, row)) for row in rows).encode()


def curet_table(geometries=205):
    """`table.txt`: the view at 0.3 rad all around, the illumination at 1.2 rad."""
    rows = (f"{g + 1} 0.3 {-3.0 + g / 40:.6f} 1.2 0.5" for g in range(geometries))
    return "\r\n".join(rows).encode()


def alta(parametrisation="ISOTROPIC_TL_TV_PROJ_DPHI", out="INV_STERADIAN", rows=None, vs="0"):
    """ALTA text with one value; the first row is the brightest, 3 sr⁻¹ with the light at 0.5."""
    if rows is None:
        rows = [(0.5, -0.5, 0.0, 3.0), (0.5, 0.5, 0.0, 0.25), (1.0, 0.0, 0.25, 0.125)]
    coordinates = len(rows[0]) - 1 - int(vs)
    header = ["# a comment", '#SAMPLE "A paint"', f"#DIM {coordinates} 1", f"#VS {vs}"]
    header += [f"#PARAM_IN {parametrisation}"] + ([f"#PARAM_OUT {out}"] if out else [])
    return "\n".join([*header, *("\t".join(map(str, row)) for row in rows), ""]).encode()


def utia():
    """The 1.9 MB of a UTIA table: red grows with theta_i, green with theta_v, blue is 0.25."""
    theta = np.linspace(0.25, 1.5, 6).repeat(48)
    red, green = np.broadcast_to(theta[:, None], (288, 288)), np.broadcast_to(theta, (288, 288))
    return np.stack([red, green, np.full((288, 288), 0.25)]).astype("<f8").tobytes()


def table():
    """An isotropic table."""
    values = 1 + np.arange(72.0).reshape(*MERL_SHAPE, 3)
    values[0, 0, 0] = np.nan
    return Measured.from_table(values, name="paint", info={"note": "made up"})


def spectrum(anisotropic=False):
    """Samples of three wavelengths, one negative, one not valid."""
    theta = np.linspace(0.1, 1.2, 12)
    wi, wo = from_angles(theta, 0.3 * anisotropic * theta), from_angles(theta[::-1], 3 * theta)
    values = np.random.default_rng(0).random((12, 3)) - 0.01
    channels = tuple(f"{w}nm" for w in WAVELENGTHS)
    valid, errors = theta > 0.15, 0.01 * np.abs(values)
    rest = {"anisotropic": anisotropic, "standard_error": errors}
    return Measured.from_samples(
        wi, wo, values, valid=valid, channels=channels, name="paint", **rest
    )


def brushed():
    """An anisotropic table."""
    return Measured.from_table(1 + np.arange(96.0).reshape(4, 3, 2, 4, 1), channels=("Y",))


def fit():
    """A fit that nobody made."""
    model = labels.model("ward")(alpha_u=0.1, alpha_v=0.4)
    return Fit(model, "paint", "log", 0.1, 72, 9, 0.5, "converged")


# of the tables in an RGL file, which has 16 MB otherwise
FEW_NODES = encoding.Resolution(phi_i=0, theta_i=3, phi_m=1, theta_m=8, grid=5)
FEW_ALL_AROUND = encoding.Resolution(phi_i=2, theta_i=3, phi_m=8, theta_m=8, grid=5)
# of tables in which a highlight still is one
SOME_NODES = encoding.Resolution(phi_i=0, theta_i=6, phi_m=1, theta_m=32, grid=16)
SOME_ALL_AROUND = encoding.Resolution(phi_i=3, theta_i=6, phi_m=16, theta_m=32, grid=16)
MATERIALS = {"table": table, "spectrum": spectrum, "brushed": brushed, "fit": fit}


@cache
def written():
    """What each format that writes makes of the first of `MATERIALS` that it can hold, by name."""
    found = {}
    for module in filter(lambda m: hasattr(m, "write"), list_formats()):
        name = module.__name__.rpartition(".")[2]
        for make in MATERIALS.values():
            stream = io.BytesIO()
            try:
                with mock.patch.object(encoding, "ISOTROPIC", FEW_NODES):
                    module.write(make(), stream)
            except BrdfkitError:
                continue
            found[f"{name}, written"] = (f"paint{module.SUFFIXES[0]}", stream.getvalue())
            break
    return found


def rgl_file(source):
    """The bytes of a small RGL file of a material or a model, close to it."""
    stream = io.BytesIO()
    some = {"ISOTROPIC": SOME_NODES, "ANISOTROPIC": SOME_ALL_AROUND}
    with mock.patch.multiple(encoding, **some):
        rgl.write(source, stream)
    return stream.getvalue()


def adaptive(data):
    """What the bytes of an RGL file hold."""
    return rgl.read(Source(Path("paint.bsdf"), None, data))


def csv():
    """What a spreadsheet of Central Europe saves: an index, decimal commas, an empty value."""
    rows = [
        ";theta_i [deg];theta_o [deg];delta_phi [deg];450nm;550nm;450nm_error;550nm_error",
        "0;30,0;30,0;180;3,0;2,0;0,01;0,02",
        "1;30,0;-10,5;180;0,25;-0,125;0,01;0,02",
        "2;60,0;30,0;90;;0,5;0,01;0,02",
        ";;;;;;;",
    ]
    return "\r\n".join(["# Sample: a paint", "# made up", *rows, ""]).encode()


FILES = {  # format or convention: (name, content)
    "merl": ("grey.binary", merl()),
    "cornell": ("paint.brdf", cornell()),
    "astm": ("paint.astm", astm()),
    "mini_diff": ("copper.astm", mini_diff()),
    "curet": ("abrdf.dat", curet()),
    "alta": ("paint.dat", alta()),
    "utia": ("paint.bin", utia()),
    "csv": ("paint.csv", csv()),
}


def place(folder, kind, data=None, name=None):
    """Write a file of `kind` into `folder`, with `data` in place of the valid content.

    Returns the path to load.
    """
    default, content = {**written(), **FILES}[kind]
    path = folder / (name or default)
    path.write_bytes(content if data is None else data)
    if kind != "curet":
        return path
    (folder / "table.txt").write_bytes(curet_table())
    return path.with_name(path.name + "#1")


def assert_same(a: Samples, b: Samples):
    """The same samples to the last bit."""
    for name in ("wi", "wo", "values", "valid"):
        np.testing.assert_array_equal(getattr(a, name), getattr(b, name), err_msg=name)
