"""Turns words of the command line into materials, parameter values and files to write."""

from contextlib import contextmanager, suppress
from pathlib import Path

from brdfkit.cli.settings import parse_settings
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.files import make_folder, require_writable, write_safely
from brdfkit.materials import resolve
from brdfkit.model import labels
from brdfkit.rendering.film import film_suffix
from brdfkit.rendering.montage import picture_suffix

FIGURES = ".png", ".pdf", ".svg"


def material(name, settings=()):
    """The material of a name or a file; of a model with `settings`, see `model_values`."""
    if not settings:
        return resolve.to_material(name)
    label = labels.load_files(name)
    if not labels.is_label(label):
        raise BrdfkitError(f"{name} is no model: --set works for models only.")
    return labels.model(label)(**model_values(label, settings))


def measured_material(name, mends):
    """The measured material of a name or a file, mended as `mends`, of `mend_options`, say."""
    found = resolve.to_measured(name)
    return found.mend(**mends) if mends else found


def refuse_mends(name, what, mends):
    """Raise `BrdfkitError` where `mends` were given for `name`, which is `what`."""
    if mends:
        raise BrdfkitError(
            f"{name} is {what}: --mirror-azimuth and --divide-by-cos are for measured samples only."
        )


def model_values(label, settings):
    """The values by name of ``PARAMETER=VALUE`` settings; an error where the model lacks one."""
    values = parse_settings(settings, "--set", "VALUE", "R,G,B")
    for parameter in values:
        labels.model(label).parameter(parameter)
    return values


@contextmanager
def results_folder(path):
    """Make the folder `path`, unless None; after the block, remove it where it is empty."""
    if path is None:
        yield
        return
    made = [p for p in (path, *path.parents) if not p.exists()]
    try:
        make_folder(path)
        yield
    finally:
        for p in made:
            with suppress(OSError):  # rmdir takes empty folders only
                p.rmdir()


def picture_file(name):
    """The path of a picture; an error, before the long rendering, where it cannot be written."""
    path = Path(name)
    picture_suffix(path)
    require_writable(path)
    require_writable(path.with_suffix(".png"))
    return path


def film_file(name):
    """The path of a film; an error, before the long rendering, where it cannot be written."""
    path = Path(name)
    film_suffix(path)
    require_writable(path)
    return path


def figure_file(name):
    """The path of a matplotlib figure; an error where it cannot be written."""
    path = Path(name)
    if path.suffix.lower() not in FIGURES:
        raise BrdfkitError(f"{path}: this picture is written as {', '.join(FIGURES)}; choose one.")
    require_writable(path)
    return path


def write_figure(figure, path):
    """Write a matplotlib `Figure` to `path`, whole or not at all."""
    with write_safely(path) as beside:
        figure.savefig(beside, dpi=130)
