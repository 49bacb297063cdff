"""The public names as a type checker sees them: `make lint` runs mypy over this file."""

from pathlib import Path
from typing import Any, assert_type

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

import brdfkit as bk
from brdfkit.checks import Report
from brdfkit.images.errors import ImageErrors
from brdfkit.materials.converting import Conversion
from brdfkit.materials.goniometer.microgeometry import gaussian

Floats = NDArray[np.float64]
Values = dict[str, float | tuple[float, ...]]
UP = np.array([[0.0, 0.0, 1.0]])


def read_and_write(path: Path) -> None:
    """Files, in and out."""
    loaded = bk.load(path)
    assert_type(loaded, bk.Measured | bk.Fit)
    bk.save(loaded, "copper.npz")
    assert_type(bk.convert("cayman.brdf", path), Conversion)


def build() -> None:
    """Materials made in Python."""
    samples = bk.Measured.from_samples(UP, UP, [[0.2]], channels=("Y",))
    assert_type(samples, bk.Measured)
    assert_type(samples.eval(UP, UP), Floats)
    assert_type(bk.Measured.from_angles(30, 0, [20, 30], 180, [0.2, 0.9]), bk.Measured)
    assert_type(bk.Measured.from_frame({"theta_i": 30, "BRDF": 0.2}), bk.Measured)
    assert_type(bk.Measured.from_table(np.ones((9, 9, 18, 3))).values, Floats)
    ward = bk.models()["ward"](alpha_u=0.1, specular_reflectance=[0.3, 0.2, 0.1])
    assert_type(ward, bk.Model)
    assert_type(ward.changed(alpha_u=0.2), bk.Model)
    assert_type(ward.values, Values)
    assert_type(bk.measure(gaussian(slope=0.3), {"type": "diffuse"}), bk.Measured)
    assert_type(bk.plan(20, reach={"max_theta_o": 60, "in_plane": True}), bk.Plan)
    assert_type(bk.complete(samples, noise=0.05), bk.Measured)


def describe(paint: bk.Measured) -> None:
    """What is said of a material."""
    assert_type(bk.evaluate("ward", UP, UP), Floats)
    assert_type(bk.albedo(paint, [0, 0, 1]), Floats)
    assert_type(bk.audit(paint), bk.Audit)
    assert_type(bk.audit(paint).findings(), tuple[str, ...])
    assert_type(bk.plot([paint, "ward"], theta_i=(15, 45)), Figure)
    assert_type(bk.check("ward", only=["finite"]), Report)


def fit_and_render(paint: bk.Measured) -> None:
    """The way from a measurement to a picture."""
    fits = [bk.fit(paint, name, bounds={"alpha_u": (0.01, 0.5)}) for name in ("ward", "ggx")]
    assert_type(fits, list[bk.Fit])
    bk.fit(paint, "ggx", solver=bk.solvers.TrustRegion(starts=4))
    bk.fit(
        paint, "ggx", solver="slsqp", constraints=[bk.solvers.AlbedoAtMost(0.9), lambda m: 1 - m.f0]
    )
    assert_type(fits[0].model, bk.Model)
    assert_type(bk.compare(paint, fits).best, str)
    assert_type(paint.subtract(fits[0]), bk.Measured)
    assert_type(bk.uncertainty.bootstrap(fits[0], paint).standard_errors, dict[str, Floats])
    assert_type(
        bk.uncertainty.profile(fits[0], paint, parameter="alpha_u").interval, tuple[float, float]
    )
    assert_type(bk.uncertainty.prediction_error(fits[0], paint).bias, Floats)
    rendering = bk.render([paint, *fits, ("grey", {"type": "diffuse"})], size=(64, 32))
    assert_type(rendering, bk.Rendering)
    assert_type(rendering.psnr(), dict[str, float])
    assert_type(rendering.errors(), ImageErrors)
    assert_type(rendering.errors().floor, dict[str, float])
    assert_type(bk.render("kitchen.xml"), bk.Rendering)
    assert_type(bk.gallery([[paint, *fits]], scene="vase"), bk.Gallery)
    assert_type(
        bk.report(paint, ["ward", *fits], path="paint.html", settings={"loss": "cbrt"}), Path
    )


def fit_many(files: list[Path]) -> None:
    """Many materials at once."""
    found = bk.sweep(files, ["ward", "ggx"], settings={"loss": "cbrt"}, folder="fits", workers=2)
    assert_type(found, bk.Sweep)
    assert_type(found.fits, list[bk.Fit])
    assert_type(found.best, dict[str, bk.Fit])
    assert_type(found.rows[0].error, float)


def volumes() -> None:
    """Volumes, and what their values mean."""
    head = bk.volumes.load("smoke", size=32, downsample=2)
    assert_type(head, bk.volumes.Volume)
    assert_type(head.resized(2).spacing, tuple[float, float, float])
    ramp = bk.volumes.TransferFunction([0, 1], [[1, 1, 1, 0], [1, 1, 1, 1]], extinction=2.0)
    assert_type(ramp.table(64), NDArray[np.float32])
    assert_type(
        bk.volumes.TransferFunction.from_opacity([0, 1], ramp.rgba), bk.volumes.TransferFunction
    )
    assert_type(
        bk.volumes.TransferFunction.load("ct_bone").scaled_to(0, 1), bk.volumes.TransferFunction
    )


def extend() -> None:
    """Plugins of one's own."""
    assert_type(bk.load_plugins("my_plugins/"), dict[str, str])
    assert_type(bk.losses.named["log"].meaning, str)
    dictionary: dict[str, Any] = bk.models()["ggx"]().scene_dict()
    assert dictionary["type"] == "ggx"
    assert_type(bk.__version__, str)
