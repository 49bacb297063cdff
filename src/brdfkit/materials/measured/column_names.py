"""Interprets the names of a user's columns: which are coordinates, BRDF values, standard errors.

Capitals, spaces, hyphens and underscores do not matter, and a Greek letter may replace its name. A
unit may follow in brackets, as in ``theta_i [deg]``.
"""

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from brdfkit.core.colours import RGB
from brdfkit.core.errors import find_nearest_name
from brdfkit.materials.measured.angles import DEGREES, RADIANS
from brdfkit.materials.measured.coordinates import COORDINATES
from brdfkit.materials.measured.long_form import NANOMETRES
from brdfkit.materials.measured.validation import Origin

# Other names of the angles of view: r stands for reflection, s for scattering
ALIASES = {"theta_r": "theta_o", "theta_s": "theta_o", "phi_r": "phi_o", "phi_s": "phi_o"}
VALUE = re.compile(
    r"(((cc)?b[rs]df)?(?P<channel>[rgb]|[0-9]{3,6}(\.[0-9]+)?(nm)?)?|value|y)"
    r"(?P<error>(standard)?error)?"
)
PER_STERADIAN = ("1/sr", "sr-1", "sr^-1", "sr⁻¹")
# Names of columns that state the wavelength or the channel of the value in each row, and which of
# the two they state
KEYS_OF_ROWS = {"wavelength": "wavelength", "lambda": "wavelength", "channel": "channel"}
# The comment of a table to fill in, which says nothing of the values that are filled in
TASK = "fill in the empty fields, from the first row on; rows without values are left out"
EXAMPLES = ("BRDF", *RGB, "550nm", "BRDF_error", "R_error")  # names that error messages propose


@dataclass(frozen=True)
class Layout:
    """The meaning of a table's columns, which are given by their numbers.

    `coordinates`: column of each coordinate of the directions, by its name; `units`: unit of each
    coordinate, or None where the column's name states none; `channels`: names of the channels;
    `values`: column of each channel's BRDF; `errors`: column of each channel's standard errors,
    empty where there are none; `cosine`: whether the values are the BRDF times cos theta_o; `key`:
    "wavelength" or "channel", and its column, where each row has one channel's value, else None.
    """

    coordinates: dict[str, int]
    units: dict[str, str | None]
    channels: tuple[str, ...]
    values: tuple[int, ...]
    errors: tuple[int, ...]
    cosine: bool
    key: tuple[str, int] | None = None


def are_sample_columns(names: Iterable[str]) -> bool:
    """Return whether columns with these `names` give both directions and values of a BRDF."""
    texts = [_split_unit(name)[0] for name in names]
    coordinates = set(map(_match_coordinate_column, texts))
    has_values = any(map(_match_value_column, texts))
    return has_values and any(coordinates.issuperset(line) for line in COORDINATES)


def parse_layout(names: Sequence[str], origin: Origin) -> Layout:
    """Interpret the `names` of a table's columns as a `Layout`.

    Raises `BrdfkitError` for a name that is unknown or repeated, and for columns that do not give
    both directions and a BRDF.
    """
    coordinates: dict[str, int] = {}
    units: dict[str, str | None] = {}
    values: dict[tuple[str, bool], int] = {}
    cosines: set[bool] = set()
    keys: dict[str, int] = {}
    for number, name in enumerate(names):
        text, unit = _split_unit(name)
        coordinate, value = _match_coordinate_column(text), _match_value_column(text)
        key = match_channel_column(name)
        if coordinate in coordinates or value in values or (key and keys):
            raise origin.error(f"the column {_quote_name(name)} comes twice; keep one")
        if coordinate and unit in _list_allowed_units(coordinate):
            coordinates[coordinate], units[coordinate] = number, unit
        elif value and unit in (None, *PER_STERADIAN):
            values[value] = number
            cosines |= _match_cosine_convention(text, is_error=value[1])
        elif key and unit in ((None, "nm") if key == "wavelength" else (None,)):
            keys[key] = number
        else:
            known = coordinate or value or key
            raise origin.error(_describe_unknown_column(name, unit if known else None, coordinates))
    if len(cosines) > 1:
        raise origin.error(
            "has columns CCBRDF, the BRDF times cos theta_o, beside columns without the cosine; "
            "convert the ones or the others"
        )
    _require_both_directions(coordinates, origin)
    channels, columns, errors = _group_by_channel(values, origin)
    for key in keys:
        if channels != ("Y",):
            raise origin.error(
                f"has values of {_join_channels(channels)} beside a column {key}; keep one column "
                f"of values, BRDF, with a row for each {key}, or leave the column {key} out"
            )
    row_key = next(iter(keys.items()), None)
    return Layout(coordinates, units, channels, columns, errors, cosines == {True}, row_key)


def match_channel_column(name: str) -> str | None:
    """Return what a column of this name states about each row's value.

    It is "wavelength" or "channel", or None for all other columns.
    """
    return KEYS_OF_ROWS.get(_simplify_name(_split_unit(name)[0]))


def _describe_unknown_column(name: str, unit: str | None, coordinates: Iterable[str]) -> str:
    """Return the text of an error on a column with an unknown `unit`, or with an unknown name.

    The name is meant where `unit` is None. The text proposes a similar name, but none of
    `coordinates`, which the table has already.
    """
    if unit is not None:
        return (
            f"the column {_quote_name(name)} has the unit {unit[:20]!r}, where deg or rad belongs "
            "for angles, 1/sr for values and nm for wavelengths; convert the column"
        )
    others = {name for line in COORDINATES for name in line} - set(coordinates)
    near = find_nearest_name(_split_unit(name)[0][:40], [*sorted(others), *EXAMPLES])
    guess = f"; did you mean {near}? Else rename it" if near else "; rename it"
    return f"the column {_quote_name(name)} is unknown{guess} or leave it out"


def _require_both_directions(coordinates: Mapping[str, int], origin: Origin) -> None:
    """Raise `BrdfkitError` unless these coordinates, by name, determine both directions.

    The allowed sets of names are the lines of `COORDINATES`.
    """
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


def _group_by_channel(
    columns: Mapping[tuple[str, bool], int], origin: Origin
) -> tuple[tuple[str, ...], tuple[int, ...], tuple[int, ...]]:
    """Return the names of the channels, the columns of their values, and those of their errors.

    `columns` has each column's number by its channel and whether it contains standard errors.
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
            f"has values of {_join_channels(channels)}, where R, G, B belong, or wavelengths such "
            "as 550nm, or one column BRDF; correct the names"
        )
    if errors and set(errors) != set(channels):
        raise origin.error(
            f"has standard errors of {_join_channels(errors)} for the values of "
            f"{_join_channels(channels)}; give those of all, as R_error or BRDF_error, or none"
        )
    error_columns = tuple(errors[c] for c in channels) if errors else ()
    return channels, tuple(values[c] for c in channels), error_columns


def _split_unit(name: str) -> tuple[str, str | None]:
    """Split a column's name into the name itself and the unit in brackets behind it, or None."""
    name = name.strip()
    bracket = max(name.rfind("["), name.rfind("("))
    if bracket < 0 or name[-1] not in "])":
        return name, None
    return name[:bracket], name[bracket + 1 : -1].strip().lower()


def _simplify_name(text: str) -> str:
    """Return a name in lower case, with Greek letters spelt out, without blanks, - and _."""
    for letter, word in {"θ": "theta", "φ": "phi", "ϕ": "phi", "δ": "delta", "λ": "lambda"}.items():
        text = text.lower().replace(letter, word)
    return re.sub(r"[\s_-]", "", text)


KEYS = {_simplify_name(name): name for line in COORDINATES for name in line}
KEYS |= {_simplify_name(alias): name for alias, name in ALIASES.items()}


def _match_coordinate_column(text: str) -> str | None:
    """Return the coordinate that a column of this name contains, such as "theta_i", or None."""
    return KEYS.get(_simplify_name(text))


def _match_value_column(text: str) -> tuple[str, bool] | None:
    """Return the channel of a column with this name, and whether it contains standard errors.

    The result is None for a column that contains neither values nor errors of a BRDF.
    """
    match = VALUE.fullmatch(_simplify_name(text))
    if not match or not match[0]:
        return None
    channel = (match["channel"] or "y").upper()
    if channel[0].isdigit():
        wavelength = float(channel.removesuffix("NM"))
        if not NANOMETRES[0] <= wavelength <= NANOMETRES[1]:
            return None
        channel = f"{wavelength:.10g}nm"
    return channel, bool(match["error"])


def _match_cosine_convention(text: str, is_error: bool) -> set[bool]:
    """Return {True} if a column of this name contains the BRDF times cos theta_o, else {False}.

    The result is empty for a column of errors whose name does not say, because errors follow the
    convention of their values.
    """
    simple = _simplify_name(text)
    if is_error and not re.match("(cc)?b[rs]df", simple):
        return set()
    return {simple.startswith("cc")}


def _list_allowed_units(coordinate: str) -> tuple[str | None, ...]:
    """Return the units that the column of a coordinate may state; None stands for no unit."""
    return (None,) if coordinate.startswith("w") else (None, *DEGREES, *RADIANS)


def _join_channels(channels: Iterable[str]) -> str:
    return ", ".join("BRDF" if channel == "Y" else channel for channel in channels)[:60]


def _quote_name(name: str) -> str:
    return repr(name[:40])
