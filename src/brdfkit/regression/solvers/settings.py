"""Converts arguments of a fit to solvers and constraints, and these to data for saved fits.

An argument may be an object, a name, or a dictionary from a saved fit.
"""

from collections.abc import Iterable, Mapping
from typing import Any

from brdfkit.core.errors import BrdfkitError, no_such_error
from brdfkit.core.json_values import to_json
from brdfkit.regression.solvers.albedo_at_most import AlbedoAtMost
from brdfkit.regression.solvers.constraints import WeightsAtMost
from brdfkit.regression.solvers.differential_evolution import DifferentialEvolution
from brdfkit.regression.solvers.levenberg_marquardt import LevenbergMarquardt
from brdfkit.regression.solvers.slsqp import SLSQP
from brdfkit.regression.solvers.trust_region import TrustRegion

SOLVERS: dict[str, Any] = {
    "levenberg_marquardt": LevenbergMarquardt,
    "slsqp": SLSQP,
    "trust_region": TrustRegion,
    "differential_evolution": DifferentialEvolution,
}
CONSTRAINTS: dict[str, Any] = {"albedo_at_most": AlbedoAtMost, "weights_at_most": WeightsAtMost}


def to_solver(value: Any) -> Any:
    """Return the solver that an argument of a fit describes.

    `value`: the solver itself, its name, or a dictionary with its name and settings.
    """
    if isinstance(value, str):
        value = {"name": value}
    if isinstance(value, Mapping):
        return _make_object_from_data("solver", SOLVERS, value)
    if value is not None and (isinstance(value, type) or not hasattr(value, "minimise")):
        raise BrdfkitError(
            f"solver = {value!r} should be a solver such as SLSQP(), or the name of one: "
            f"{', '.join(SOLVERS)}."
        )
    return value


def to_constraints(value: Any) -> tuple[Any, ...]:
    """Return the constraints that an argument of a fit describes, as a tuple.

    `value`: one or several objects of brdfkit, functions, or dictionaries from a saved fit.
    """
    if value is None:
        return ()
    several = isinstance(value, Iterable) and not isinstance(value, Mapping | str)
    return tuple(map(_to_constraint, value if several else [value]))


def _to_constraint(value: Any) -> Any:
    """Return one constraint; `value`: an object of brdfkit, a function, or a dictionary."""
    if isinstance(value, Mapping):
        return _make_object_from_data("constraint", CONSTRAINTS, value)
    if isinstance(value, type) or not (callable(value) or hasattr(value, "slopes")):
        raise BrdfkitError(
            f"{value!r} is no constraint; give one such as AlbedoAtMost(1.0), or a function of the "
            "model that returns a number ≥ 0 where it is met."
        )
    return value


def to_plain_data(setting: Any) -> Any:
    """Return a solver or a constraint as data that JSON can store.

    An object of brdfkit becomes a dictionary of its name and settings, a user's own only a name.
    """
    for name, cls in (SOLVERS | CONSTRAINTS).items():
        if type(setting) is cls:
            return {"name": name, **to_json(setting)}
    return setting and getattr(setting, "__qualname__", type(setting).__qualname__)


def require_supported_constraints(
    solver: Any, constraints: tuple[Any, ...], robust: str | None
) -> None:
    """Raise `BrdfkitError` for constraints that the solver or a robust fit does not support."""
    if constraints and robust:
        raise BrdfkitError(
            "A robust fit takes no constraints, because its passes would violate them; leave out "
            "robust or the constraints."
        )
    if constraints and solver is not None and not getattr(solver, "constrained", False):
        raise BrdfkitError(
            f"{type(solver).__name__} takes no constraints; take SLSQP, or leave the solver out."
        )


def require_plain_data(solver: Any, constraints: tuple[Any, ...]) -> None:
    """Raise `BrdfkitError` for a user's solver or constraint, as other processes lack its code."""
    for setting in (solver, *constraints):
        if isinstance(to_plain_data(setting), str):
            raise BrdfkitError(
                f"{to_plain_data(setting)} is your own code, which cannot be sent to other "
                "processes; take a solver and constraints of brdfkit."
            )


def _make_object_from_data(kind: str, classes: Mapping[str, Any], data: Mapping[str, Any]) -> Any:
    """Return an object of one of the `classes` from the data that `to_plain_data` made of it.

    `kind`: "solver" or "constraint", for error messages.
    """
    numbers = dict(data)
    name = numbers.pop("name", None)
    if not isinstance(name, str) or name not in classes:
        raise no_such_error(kind, name, classes)
    known = classes[name].__dataclass_fields__
    for number in numbers:
        if number not in known:
            raise no_such_error(f"parameter of {name}", number, known)
    return classes[name](**numbers)
