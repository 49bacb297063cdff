"""Checks whether materials and plugins do what a renderer and a fit require of them.

A check is a function `(subject) -> (passed, figure)` with the decorator `check_of(KIND)`, in a file
of this folder; the figure is a text with what was measured. Checks of a material take a `Subject`;
they are in `physics.py`, `sampling.py` and `derivatives.py`. Checks of another kind of plugin take
a `PluginSubject`; they are in the file of their kind. The tests run all checks on all materials and
plugins.
"""

from __future__ import annotations

import importlib
import pkgutil
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

from brdfkit.checks.material_subject import Subject
from brdfkit.checks.plugin_subject import PluginSubject, is_no_model, make_example
from brdfkit.checks.registry import Finding, checks, describe_error
from brdfkit.core.discovery import plugin_files
from brdfkit.core.discovery.plugin_files import KINDS, MODELS
from brdfkit.core.documents import Cell, Document, Shown, Table
from brdfkit.core.documents.parts import BAD, GOOD
from brdfkit.core.errors import BrdfkitError, find_nearest_name, no_such_error
from brdfkit.core.interrupts import is_interrupt
from brdfkit.core.jit import llvm
from brdfkit.core.jit.threads import in_turn
from brdfkit.core.progress_bar import Progress
from brdfkit.materials.resolve import MaterialLike, to_material
from brdfkit.mitsuba_bridge.properties.picture_file import load_by_mitsuba

for _module in pkgutil.iter_modules(__path__):
    importlib.import_module(f"{__name__}.{_module.name}")


@dataclass(frozen=True, repr=False)
class Report(Shown):
    """The result of `check`, which is true if all checks passed; it prints as a list.

    Attributes
    ----------
    name : str
        Name of the material or plugin.
    findings : tuple of Finding
        For each check its name (`check`), whether it `passed`, and the measured `figure` as a text.
    """

    name: str
    findings: tuple[Finding, ...]

    def __bool__(self) -> bool:
        return all(finding.passed for finding in self.findings)

    def document(self) -> Document:
        """Return the report as a table, with one row per check: result, name, measured figure."""
        rows = tuple(
            (Cell("ok", GOOD) if f.passed else Cell("FAIL", BAD), f.check, f.figure)
            for f in self.findings
        )
        return Document(f"{self.name}: {'passed' if self else 'failed'}", (Table(rows),))


@in_turn
def check(
    material: MaterialLike,
    *,
    only: Iterable[str] | None = None,
    progress: Progress | None = None,
) -> Report:
    """Check whether a material or a plugin does what a renderer and a fit require of it.

    The checks of a material are its sampling (χ² tests at five angles of incidence, coverage,
    weight = eval / pdf), reciprocity, finite values up to the horizon, energy, derivatives, and
    that the Mitsuba plugin computes the formula. The checks of an emitter or a phase function are
    χ² tests, weights, normalisation and means. An integrator has to render the reference scene of
    its file with the known radiance. A plugin whose code raises an error has failed. All checks run
    in the current variant of Mitsuba or, if none is set, in the best variant that works.

    Parameters
    ----------
    material : Model, Fit, Measured, str, Path or dict
        The material, or its name or path; or the name of a plugin of another kind, or its
        dictionary for `mitsuba.load_dict`.
    only : list of str, optional
        Names of the checks to run; by default all checks for the kind.
    progress : callable, optional
        Called with (number of checks done, number of all checks).

    Returns
    -------
    Report
        True if all checks passed; it prints as a list.

    Raises
    ------
    BrdfkitError
        For an unknown check, for anything that is no material or plugin, and in a scalar variant of
        Mitsuba.

    Examples
    --------
    >>> print(check("ward"))    # doctest: +SKIP
    """
    if llvm.use_variant().startswith("scalar"):
        usable = llvm.find_loaded_version() >= llvm.OLDEST
        remedy = "set llvm_ad_rgb" if usable else llvm.describe_llvm_remedy()
        raise BrdfkitError(f"check needs an LLVM or CUDA variant of Mitsuba; {remedy}.")
    subject, kind, name = _make_subject(material)
    only = [only] if isinstance(only, str) else only
    names = list(checks[kind]) if only is None else list(only)
    for wanted in names:
        if wanted not in checks[kind]:
            raise no_such_error("check", wanted, checks[kind])
    if kind != MODELS and not _can_load(subject):
        names = ["loads"]  # the other checks would fail with the same error
    findings: list[Finding] = []
    for wanted in names:
        findings.append(Finding(wanted, *_run_check(kind, wanted, subject)))
        if progress:
            progress(len(findings), len(names))
    return Report(name, tuple(findings))


def _make_subject(material: MaterialLike) -> tuple[Subject | PluginSubject, str, str]:
    """Return the `Subject` or `PluginSubject` to check, its kind of plugin, and its name."""
    if isinstance(material, str) and is_no_model(material):
        material = make_example(material)
    name = material.get("type") if isinstance(material, dict) else None
    kind = plugin_files.find_plugin_kind(name) if isinstance(name, str) else None
    if isinstance(material, dict) and kind not in (None, MODELS):
        return PluginSubject(kind, material), kind, str(name)
    converted = _find_material(material)
    if name and kind is None:  # one of Mitsuba's own plugins, or an unknown one
        import mitsuba as mi

        load_by_mitsuba(mi.load_dict, converted.scene_dict(), name)
    return Subject(converted), MODELS, converted.name


def _find_material(material: MaterialLike) -> Any:
    """Convert to a material as `to_material` does, but propose plugins, too, for unknown names."""
    try:
        return to_material(material)
    except BrdfkitError:
        others = [n for kind in KINDS if kind != MODELS for n in plugin_files.find_plugins(kind)]
        if isinstance(material, str) and find_nearest_name(material, others):
            raise no_such_error("plugin", material, others) from None
        raise


def _can_load(subject: Any) -> bool:
    """Return whether Mitsuba can make an instance of the subject's plugin."""
    try:
        return subject.plugin is not None
    except Exception:
        return False


def _run_check(kind: str, name: str, subject: Subject | PluginSubject) -> tuple[bool, str]:
    """Run one check and return (passed, figure); it fails if the plugin's code raises an error."""
    try:
        return checks[kind][name](subject)
    except BrdfkitError:
        raise
    except Exception as error:
        if is_interrupt(error):
            raise KeyboardInterrupt from None
        if subject.source is None:
            raise
        return False, describe_error(error, subject.source)
