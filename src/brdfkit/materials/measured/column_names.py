"""Says by their names what the columns of a user's table hold: coordinates, values or errors.

Capitals, spaces, hyphens and underscores do not matter, and a Greek letter counts as its name. A
unit may follow in brackets, as in ``theta_i [deg]``.
"""

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from brdfkit.core.colours import RGB
from brdfkit.core.errors import nearest
from brdfkit.materials.measured.angles import DEGREES, RADIANS
from brdfkit.materials.measured.coordinates import COORDINATES
from brdfkit.materials.measured.long_form import NANOMETRES
from brdfkit.materials.measured.validation import Origin

# Other names of the outgoing direction: r for reflection, s for scattering
ALIASES = {"theta_r": "theta_o", "theta_s": "theta_o", "phi_r": "phi_o", "phi_s": "phi_o"}
VALUE = re.compile(
    r"(((cc)?b[rs]df)?(?P<channel>[rgb]|[0-9]{3,6}(\.[0-9]+)?(nm)?)?|value|y)"
    r"(?P<error>(standard)?error)?"
)
PER_STERADIAN = ("1/sr", "sr-1", "sr^-1", "sr⁻¹")
# Columns that say which wavelength or channel the value in a row belongs to
KEYS_OF_ROWS = {"wavelength": "wavelength", "lambda": "wavelength", "channel": "channel"}
EXAMPLES = ("BRDF", *RGB, "550nm", "BRDF_error", "R_error")  # proposed for names that are unknown


@dataclass(frozen=True)
class Layout:
    """The meaning of each column of a table; columns are given as their numbers.

    `coordinates`: the columns of one line of `COORDINATES`, by name; `units`: the units that the
    names of these columns state, or None; `channels`: names of the channels; `values` and `errors`:
    the columns of each channel's values and standard errors, if any; `cosine`: whether the values
    are the BRDF times cos theta_o; `key`: "wavelength" or "channel" and its column where each row
    has the value of one channel, else None.
    """

    coordinates: dict[str, int]
    units: dict[str, str | None]
    channels: tuple[str, ...]
    values: tuple[int, ...]
    errors: tuple[int, ...]
    cosine: bool
    key: tuple[str, int] | None = None


def are_columns(names: Iterable[str]) -> bool:
    """Return whether `names` have the columns of a line of `COORDINATES`, and one of values."""
    texts = [_split_unit(name)[0] for name in names]
    coordinates = set(map(_match_coordinate, texts))
    has_values = any(map(_match_value, texts))
    return has_values and any(coordinates.issuperset(line) for line in COORDINATES)


def parse_layout(names: Sequence[str], origin: Origin) -> Layout:
    """Return the `Layout` of columns with these `names`.

    Raises `BrdfkitError` for a name that is unknown or comes twice, and where the columns do not
    give both directions, or no BRDF.
    """
    coordinates: dict[str, int] = {}
    units: dict[str, str | None] = {}
    values: dict[tuple[str, bool], int] = {}
    cosines: set[bool] = set()
    keys: dict[str, int] = {}
    for number, name in enumerate(names):
        text, unit = _split_unit(name)
        coordinate, value = _match_coordinate(text), _match_value(text)
        key = find_row_key(name)
        if coordinate in coordinates or value in values or (key and keys):
            raise origin.error(f"the column {_quote(name)} comes twice; keep one")
        if coordinate and unit in _list_units(coordinate):
            coordinates[coordinate], units[coordinate] = number, unit
        elif value and unit in (None, *PER_STERADIAN):
            values[value] = number
            cosines |= _find_cosine(text, is_error=value[1])
        elif key and unit in ((None, "nm") if key == "wavelength" else (None,)):
            keys[key] = number
        else:
            known = coordinate or value or key
            raise origin.error(_describe_unknown(name, unit if known else None, coordinates))
    if len(cosines) > 1:
        raise origin.error("has CCBRDF, values with a cosine, beside others; convert them")
    _require_both_directions(coordinates, origin)
    channels, columns, errors = _find_channels(values, origin)
    for key in keys:
        if channels != ("Y",):
            raise origin.error(
                f"has values of {_join(channels)} beside a column {key}; keep one column of "
                f"values, BRDF, with a row for each {key}, or leave the column {key} out"
            )
    row_key = next(iter(keys.items()), None)
    return Layout(coordinates, units, channels, columns, errors, cosines == {True}, row_key)


def find_row_key(name: str) -> str | None:
    """Return "wavelength" or "channel" if a column states it for each row, else None."""
    return KEYS_OF_ROWS.get(_simplify(_split_unit(name)[0]))


def _describe_unknown(name: str, unit: str | None, coordinates: Iterable[str]) -> str:
    """Return the words for a column with an unknown `unit`, or, where it is None, an unknown name.

    `coordinates`: the names of the columns that are known already.
    """
    if unit is not None:
        return (
            f"the column {_quote(name)} has the unit {unit[:20]!r}, where deg or rad belongs for "
            "angles, 1/sr for values and nm for wavelengths; convert the column"
        )
    others = {name for line in COORDINATES for name in line} - set(coordinates)
    near = nearest(_split_unit(name)[0][:40], [*sorted(others), *EXAMPLES])
    guess = f"; did you mean {near}? Else rename it" if near else "; rename it"
    return f"the column {_quote(name)} is unknown{guess} or leave it out"


def _require_both_directions(coordinates: Mapping[str, int], origin: Origin) -> None:
    """Raise `BrdfkitError` unless `coordinates` has the names in one line of `COORDINATES`."""
    if set(coordinates) in map(set, COORDINATES):
        return
    like = max(COORDINATES, key=lambda line: len(set(line) & set(coordinates)))
    missing = [name for name in like if name not in coordinates]
    if not missing:
        raise origin.error(
            f"has {', '.join(name for name in coordinates if name not in like)} beside "
            f"{', '.join(like)}, which give both directions alone; keep one of the two"
        )
    hint = ""
    if set(missing) <= {"phi_i", "phi_o"} and "delta_phi" not in coordinates:
        hint = ", or delta_phi for phi_o - phi_i; in the plane of incidence, 180 throughout, with "
        hint += "theta_o below 0 on the light's side"
    raise origin.error(f"lacks the columns {', '.join(missing)}; add them{hint}")


def _find_channels(
    columns: Mapping[tuple[str, bool], int], origin: Origin
) -> tuple[tuple[str, ...], tuple[int, ...], tuple[int, ...]]:
    """Return the channels, the columns of their values, and the columns of their errors.

    `columns` has the number of each column by (channel, whether the column is of errors).
    """
    values = {channel: number for (channel, error), number in columns.items() if not error}
    errors = {channel: number for (channel, error), number in columns.items() if error}
    channels = tuple(values)
    if not channels:
        raise origin.error("has no column of values; name it BRDF, or name three of them R, G, B")
    if set(channels) == set(RGB):
        channels = RGB
    elif channels != ("Y",) and not all(channel.endswith("nm") for channel in channels):
        raise origin.error(
            f"has values of {_join(channels)}, where R, G, B belong, or wavelengths such "
            "as 550nm, or one column BRDF; mend the names"
        )
    if errors and set(errors) != set(channels):
        raise origin.error(
            f"has standard errors of {_join(errors)} for the values of {_join(channels)}; give "
            "those of all, as R_error or BRDF_error, or none"
        )
    error_columns = tuple(errors[c] for c in channels) if errors else ()
    return channels, tuple(values[c] for c in channels), error_columns


def _split_unit(name: str) -> tuple[str, str | None]:
    """Return a column's name without its unit, and the unit in lower case, None where it has none.

    The unit stands in brackets behind the name.
    """
    name = name.strip()
    bracket = max(name.rfind("["), name.rfind("("))
    if bracket < 0 or name[-1] not in "])":
        return name, None
    return name[:bracket], name[bracket + 1 : -1].strip().lower()


def _simplify(text: str) -> str:
    """Return a name in lower case, without spaces, hyphens and underscores, in Latin letters."""
    for letter, word in {"θ": "theta", "φ": "phi", "ϕ": "phi", "δ": "delta", "λ": "lambda"}.items():
        text = text.lower().replace(letter, word)
    return re.sub(r"[\s_-]", "", text)


KEYS = {_simplify(name): name for line in COORDINATES for name in line}
KEYS |= {_simplify(alias): name for alias, name in ALIASES.items()}


def _match_coordinate(text: str) -> str | None:
    """Return the coordinate that a column of this name holds, or None."""
    return KEYS.get(_simplify(text))


def _match_value(text: str) -> tuple[str, bool] | None:
    """Return the channel that a column of this name holds, and whether it holds standard errors;
    None for a column without values."""
    match = VALUE.fullmatch(_simplify(text))
    if not match or not match[0]:
        return None
    channel = (match["channel"] or "y").upper()
    if channel[0].isdigit():
        wavelength = float(channel.removesuffix("NM"))
        if not NANOMETRES[0] <= wavelength <= NANOMETRES[1]:
            return None
        channel = f"{wavelength:.10g}nm"
    return channel, bool(match["error"])


def _find_cosine(text: str, is_error: bool) -> set[bool]:
    """Return whether a column of this name holds the BRDF times cos theta_o, as a set of one.

    The set is empty for errors whose name does not say: they are as the values are.
    """
    simple = _simplify(text)
    if is_error and not re.match("(cc)?b[rs]df", simple):
        return set()
    return {simple.startswith("cc")}


def _list_units(coordinate: str) -> tuple[str | None, ...]:
    """Return the units that a column of this coordinate may state."""
    return (None,) if coordinate.startswith("w") else (None, *DEGREES, *RADIANS)


def _join(channels: Iterable[str]) -> str:
    return ", ".join("BRDF" if channel == "Y" else channel for channel in channels)[:60]


def _quote(name: str) -> str:
    return repr(name[:40])
