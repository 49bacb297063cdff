"""What every material must fulfil: `check`. The test-suite runs the same over every model.

A check is a function `(subject) -> (passed, figure)` with the decorator `checked`, in a module
of this folder.
"""

import importlib
import pkgutil
from dataclasses import dataclass

from brdfkit import llvm
from brdfkit.checks.failure import described
from brdfkit.checks.subject import Finding, Subject, checks
from brdfkit.errors import BrdfkitError, no_such
from brdfkit.materials import material
from brdfkit.threads import in_turn

for _module in pkgutil.iter_modules(__path__):
    importlib.import_module(f"{__name__}.{_module.name}")


@dataclass(frozen=True)
class Report:
    """What `check` found; true when everything passed."""

    name: str
    findings: tuple[Finding, ...]

    def __bool__(self):
        return all(finding.passed for finding in self.findings)

    def __str__(self):
        width = max(len(f.check) for f in self.findings)
        lines = [
            f"  {'ok  ' if f.passed else 'FAIL'}  {f.check:<{width}}  {f.figure}"
            for f in self.findings
        ]
        return "\n".join([f"{self.name}: {'passed' if self else 'failed'}", *lines])


@in_turn
def check(thing, only=None, progress=None):
    """Check a model with values, a fit or a measured material; returns a `Report`.

    Sampling (χ² at five incidences to grazing, coverage, weight = eval / pdf), reciprocity,
    finiteness to the horizon, energy, derivatives, and that the Mitsuba plugin computes the
    formula. A model that raises an error has failed. `only`: names of checks; `progress`: called
    with (done, total). Raises `BrdfkitError` for an unknown check, for what is no material, and
    without an LLVM or CUDA variant.

    >>> print(check(models()["ward"](alpha_u=0.1)))    # doctest: +SKIP
    """
    thing = material(thing)
    if llvm.use_variant().startswith("scalar"):
        usable = llvm.loaded_version() >= llvm.OLDEST
        remedy = "set llvm_ad_rgb" if usable else llvm.remedy()
        raise BrdfkitError(f"check needs an LLVM or CUDA variant of Mitsuba; {remedy}.")
    subject = Subject(thing)
    names = list(checks) if only is None else list(only)
    for name in names:
        if name not in checks:
            raise no_such("check", name, checks)
    findings = []
    for name in names:
        findings.append(Finding(name, *_found(name, subject)))
        if progress:
            progress(len(findings), len(names))
    return Report(thing.name, tuple(findings))


def _found(name, subject):
    """(passed, figure) of a check; a model whose lines raise an error has failed it."""
    try:
        return checks[name](subject)
    except BrdfkitError:
        raise
    except Exception as error:
        if subject.model is None:
            raise
        return False, described(error, subject.model)
