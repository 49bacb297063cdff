"""Solvers and constraints as arguments: objects, names, or the plain data that a saved fit has."""

from collections.abc import Iterable, Mapping
from typing import Any

from brdfkit.core.errors import BrdfkitError, no_such
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


def to_solver(given: Any) -> Any:
    """The solver that an argument means, an object with `minimise`; None for None."""
    if isinstance(given, str):
        given = {"name": given}
    if isinstance(given, Mapping):
        return _make("solver", SOLVERS, given)
    if given is not None and (isinstance(given, type) or not hasattr(given, "minimise")):
        raise BrdfkitError(
            f"solver = {given!r} should be a solver such as SLSQP(), or the name of one: "
            f"{', '.join(SOLVERS)}."
        )
    return given


def to_constraints(given: Any) -> tuple[Any, ...]:
    """The constraints that an argument means: our objects, and functions."""
    if given is None:
        return ()
    several = isinstance(given, Iterable) and not isinstance(given, Mapping | str)
    return tuple(map(_to_constraint, given if several else [given]))


def _to_constraint(given):
    if isinstance(given, Mapping):
        return _make("constraint", CONSTRAINTS, given)
    if isinstance(given, type) or not (callable(given) or hasattr(given, "slopes")):
        raise BrdfkitError(
            f"{given!r} is no constraint; give one such as AlbedoAtMost(1.0), or a function of the "
            "model that returns a number ≥ 0 where it is met."
        )
    return given


def to_plain(thing: Any) -> Any:
    """A solver or a constraint as JSON has it; one of a user's by its name alone."""
    for name, cls in (SOLVERS | CONSTRAINTS).items():
        if type(thing) is cls:
            return {"name": name, **to_json(thing)}
    return thing and getattr(thing, "__qualname__", type(thing).__qualname__)


def require_suitable(solver: Any, constraints: tuple[Any, ...], robust: str | None) -> None:
    """Raise `BrdfkitError` for constraints that the solver, or a robust fit, does not know of."""
    if constraints and robust:
        raise BrdfkitError(
            "A robust fit takes no constraints, for its passes would leave them; give one or the "
            "other."
        )
    if constraints and solver is not None and not getattr(solver, "constrained", False):
        raise BrdfkitError(
            f"{type(solver).__name__} takes no constraints; take SLSQP, or leave the solver out."
        )


def require_plain(solver: Any, constraints: tuple[Any, ...]) -> None:
    """Raise `BrdfkitError` for a solver or constraints that other processes could not have."""
    for thing in (solver, *constraints):
        if isinstance(to_plain(thing), str):
            raise BrdfkitError(
                f"{to_plain(thing)} is code; where other processes fit, solvers and constraints "
                "should be brdfkit's."
            )


def _make(what, classes, given):
    """The object of plain data as `to_plain` gives."""
    numbers = dict(given)
    name = numbers.pop("name", None)
    if not isinstance(name, str) or name not in classes:
        raise no_such(what, name, classes)
    known = classes[name].__dataclass_fields__
    for number in numbers:
        if number not in known:
            raise no_such(f"parameter of {name}", number, known)
    return classes[name](**numbers)
