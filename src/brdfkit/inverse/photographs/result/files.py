"""The files of an `Svbrdf`: maps, a scene of Mitsuba's, and a report."""

from pathlib import Path

import numpy as np

from brdfkit.core.files import make_folder, require_writable, write_safely
from brdfkit.core.jit.threads import use_two_threads
from brdfkit.inverse.photographs.maps.scene import scene_xml
from brdfkit.inverse.photographs.result.report import write_report

# Names of files beside the maps; what the name of a map's uncertainty ends with
MISFIT, SCENE, REPORT, ERROR = "misfit.exr", "sample.xml", "report.html", "_error"


def require_files(model, folder):
    """Make the `folder`; raise `BrdfkitError` where a file that `write_all` may write to it for a
    `model` class cannot be written."""
    make_folder(folder)
    maps = *model.parameters, "normal", "anisotropy_angle"
    names = *(f"{name}{end}.exr" for name in maps for end in ("", ERROR)), MISFIT, SCENE, REPORT
    for name in names:
        require_writable(Path(folder) / name)


def write_all(svbrdf, folder):
    """Write all files of an `Svbrdf`; returns their paths."""
    folder = Path(folder)
    make_folder(folder)
    files = {name: f"{name}.exr" for name in svbrdf.maps}
    written = []
    for name, values in svbrdf.maps.items():
        # upright, as programs show and use them; normals as colours, green along the sample's y
        shown = (values + 1) / 2 if name == "normal" else values
        written.append(_write(folder / files[name], shown))
        written += _write_known(folder / f"{name}{ERROR}.exr", svbrdf.uncertainty.get(name))
    written += _write_known(folder / MISFIT, svbrdf.misfit)
    scene = folder / SCENE
    with write_safely(scene) as beside:
        Path(beside).write_text(scene_xml(svbrdf, files), encoding="utf-8")
    report = folder / REPORT
    write_report(svbrdf, report)
    return [*written, scene, report]


def _write_known(path, values):
    """The paths written: none where there are no values, and that of other maps goes, too."""
    if values is None:
        path.unlink(missing_ok=True)
        return []
    return [_write(path, values)]


def _write(path, values):
    import mitsuba as mi

    pixels = np.ascontiguousarray(np.atleast_3d(values), np.float32)
    with write_safely(path) as beside, use_two_threads():
        try:
            mi.Bitmap(pixels).write(str(beside))
        except RuntimeError as error:  # a full disk, for instance
            raise OSError(str(error).splitlines()[0]) from error
    return path
