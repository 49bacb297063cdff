"""Defines the public function `report`, which compares models with a material in an HTML file."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any, TypeAlias

from brdfkit.core.arguments import to_dictionary
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.files import require_writable
from brdfkit.core.names import to_file_stem
from brdfkit.core.pages import page
from brdfkit.core.progress_bar import Progress
from brdfkit.fitting.ranking import Ranking
from brdfkit.fitting.settings import FitSettings, ModelLike, require_material_first
from brdfkit.materials.measured import Measured
from brdfkit.materials.resolve import MaterialLike, to_measured
from brdfkit.regression import Fit
from brdfkit.reporting.charts.svg import choose_css_class
from brdfkit.reporting.contents import Contents, collect_contents
from brdfkit.reporting.fits import make_fit, to_model_list
from brdfkit.reporting.pictures.defaults import MODELS, SCENE, SIZE
from brdfkit.reporting.pictures.pictures import check_picture_arguments, render_pictures

Fitted: TypeAlias = ModelLike | Fit
Fits: TypeAlias = Fitted | Iterable[Fitted]


def report(
    material: MaterialLike,
    models: Fits = MODELS,
    *,
    path: str | Path | None = None,
    settings: Mapping[str, Any] | None = None,
    spp: int | None = None,
    size: int = SIZE,
    scene: str | Path = SCENE,
    environment: str | Path | None = None,
    noise_floor: float | None = None,
    seed: int = 0,
    progress: Progress | None = None,
) -> Path:
    """Write one HTML file that shows how well models describe a measured material.

    It contains a verdict in words, the errors, path-traced pictures to compare, the lobes, slices
    and albedo, the parameters and the audit. Any browser shows it, without a network. Equal input
    gives an equal file. After Ctrl-C during the pictures, the file shows the samples that all of
    them have.

    Parameters
    ----------
    material : Measured, str or Path
        The measured material, its name in the catalogue, or the path of its file.
    models : str, Path, class or Fit, or several, default ("ward", "ggx", "ggx+ggx")
        The models to fit, as for `fit`, or finished fits, or the paths of saved ones, ``.json``.
    path : str or Path, optional
        The file to write, ``.html``; by default "NAME-report.html", with the material's name.
    settings : dict of str to object, optional
        Other arguments of `fit` by name, as ``{"loss": "cbrt"}``.
    spp : int, optional
        Samples per pixel of the pictures, by default 256; with `noise_floor`, the largest number.
    size : int, default 288
        Side of a picture [pixels], from 16 to 1024.
    scene : str or Path, default "ball"
        A scene's name or a mesh, as in `render`; no scene file.
    environment : str or Path, optional
        An environment map that lights the scene, as in `render`.
    noise_floor : float, optional
        The noise floor [dB] to reach by adding samples, as in `render`.
    seed : int, default 0
        Seed of the pictures' samples.
    progress : callable, optional
        Called with (steps done, steps in all) of each fit and of the pictures, one after the other.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    BrdfkitError
        For what `fit` and `render` refuse, fits of other data, and where the file cannot be
        written.

    Examples
    --------
    >>> report("car_paint", ["ward", "ggx"], path="car_paint.html")    # doctest: +SKIP
    """
    require_material_first("report(material, models)", material)
    chosen = FitSettings.from_dictionary(to_dictionary("settings", settings))
    check_picture_arguments(size, scene, environment)
    data, file = to_measured(material), material if isinstance(material, str | Path) else None
    path = require_html_path(choose_file_name(data) if path is None else path)
    fits = [make_fit(thing, data, chosen, progress) for thing in to_model_list(models)]
    pictures: dict[str, Any] = {"spp": spp, "noise_floor": noise_floor, "size": size, "seed": seed}
    write_report(
        data, fits, path, file, **pictures, scene=scene, environment=environment, progress=progress
    )
    return path


def write_report(
    material: Measured,
    fits: list[Fit],
    path: Path,
    file: str | Path | None = None,
    ranking: Ranking | None = None,
    scene: str | Path = SCENE,
    environment: str | Path | None = None,
    **pictures: Any,
) -> Contents:
    """Write the report of a material and finished fits, and return its contents.

    `file`: the material's file, if it has one; `ranking`: the ranking of models from which a fit
    was chosen, if there was one; `pictures`: further arguments of `render_pictures`. Raises
    `BrdfkitError` as `report` does.
    """
    rendering = render_pictures(material, fits, scene=scene, environment=environment, **pictures)
    contents = collect_contents(material, fits, rendering, file, path, scene, environment, ranking)
    page.write_page("report.html", path, choose_css_class=choose_css_class, **contents.page)
    return contents


def choose_file_name(material: Measured) -> str:
    """Return the default name of a report's file, made of the material's name."""
    return f"{to_file_stem(material.name)}-report.html"


def require_html_path(path: str | Path) -> Path:
    """Return the path of a report; raise `BrdfkitError` if no .html file can be written there."""
    path = Path(path)
    if path.suffix.lower() not in (".html", ".htm"):
        raise BrdfkitError(f"{path}: a report is written as .html; choose this suffix.")
    require_writable(path)
    return path
