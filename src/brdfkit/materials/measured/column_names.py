"""What the columns of a user's table are, by their names: coordinates, values, standard errors.

Capitals, spaces, hyphens and underscores do not matter, and a Greek letter is its name; a unit may
stand behind in brackets, as in ``theta_i [deg]``.
"""

import re
from dataclasses import dataclass

from brdfkit.core.colours import RGB
from brdfkit.core.errors import nearest
from brdfkit.materials.measured.angles import DEGREES, RADIANS
from brdfkit.materials.measured.coordinates import COORDINATES
from brdfkit.materials.measured.long_form import NANOMETRES

# Other names: the outgoing direction is that of reflection or of scattering
ALIASES = {"theta_r": "theta_o", "theta_s": "theta_o", "phi_r": "phi_o", "phi_s": "phi_o"}
VALUE = re.compile(
    r"(((cc)?b[rs]df)?(?P<channel>[rgb]|[0-9]{3,6}(\.[0-9]+)?(nm)?)?|value|y)"
    r"(?P<error>(standard)?error)?"
)
PER_STERADIAN = ("1/sr", "sr-1", "sr^-1", "sr⁻¹")
# Columns that say of which wavelength or channel the value in a row is
KEYS_OF_ROWS = {"wavelength": "wavelength", "lambda": "wavelength", "channel": "channel"}
EXAMPLES = ("BRDF", *RGB, "550nm", "BRDF_error", "R_error")  # proposed for names that are unknown


@dataclass(frozen=True)
class Layout:
    """The columns of a table by what they are, as their numbers.

    `coordinates`: the columns of one line of `COORDINATES`, by name; `units`: what the names of
    these state, or None; `channels`; `values` and `errors`: the columns of each channel's values
    and standard errors, if any; `cosine`: whether the values are the BRDF times cos theta_o;
    `key`: "wavelength" or "channel" and its column, where each row has the value of one; or None.
    """

    coordinates: dict[str, int]
    units: dict[str, str | None]
    channels: tuple[str, ...]
    values: tuple[int, ...]
    errors: tuple[int, ...]
    cosine: bool
    key: tuple[str, int] | None = None


def are_columns(names):
    """Whether `names` have the columns of a line of `COORDINATES`, and one of values."""
    texts = [_split(name)[0] for name in names]
    coordinates = set(map(_coordinate, texts))
    return any(map(_value, texts)) and any(coordinates.issuperset(line) for line in COORDINATES)


def understand(names, origin):
    """The `Layout` of columns with these `names`, text each; `origin`: for errors.

    Raises `BrdfkitError` for a name that is unknown or comes twice, and where the columns do not
    give both directions, or no BRDF.
    """
    coordinates, units, values, cosines, keys = {}, {}, {}, set(), {}
    for number, name in enumerate(names):
        text, unit = _split(name)
        coordinate, value = _coordinate(text), _value(text)
        key = key_of_rows(name)
        if coordinate in coordinates or value in values or (key and keys):
            raise origin.error(f"the column {_quote(name)} comes twice; keep one")
        if coordinate and unit in _units(coordinate):
            coordinates[coordinate], units[coordinate] = number, unit
        elif value and unit in (None, *PER_STERADIAN):
            values[value] = number
            cosines |= _cosines(text, is_error=value[1])
        elif key and unit in ((None, "nm") if key == "wavelength" else (None,)):
            keys[key] = number
        else:
            raise origin.error(_say_unknown(name, unit, coordinate or value or key, coordinates))
    if len(cosines) > 1:
        raise origin.error("has CCBRDF, values with a cosine, beside others; convert them")
    _require_both_directions(coordinates, origin)
    found = _find_channels(values, origin)
    for key in keys:
        if found[0] != ("Y",):
            raise origin.error(
                f"has values of {_list(found[0])} beside a column {key}; keep one column of "
                f"values, BRDF, with a row for each {key}, or leave the column {key} out"
            )
    return Layout(coordinates, units, *found, cosines == {True}, next(iter(keys.items()), None))


def key_of_rows(name):
    """What a column of this name says of each row's value: "wavelength", "channel", or None."""
    return KEYS_OF_ROWS.get(_simplify(_split(name)[0]))


def _say_unknown(name, unit, known, coordinates):
    """The sentence on a column whose name, or the unit in it, is unknown."""
    if known:
        return (
            f"the column {_quote(name)} has the unit {unit[:20]!r}, where deg or rad belongs for "
            "angles, 1/sr for values and nm for wavelengths; convert the column"
        )
    others = {name for line in COORDINATES for name in line} - set(coordinates)
    near = nearest(_split(name)[0][:40], [*sorted(others), *EXAMPLES])
    guess = f"; did you mean {near}? Else rename it" if near else "; rename it"
    return f"the column {_quote(name)} is unknown{guess} or leave it out"


def _require_both_directions(given, origin):
    """Raise `BrdfkitError` unless the coordinates `given` are those of a line of `COORDINATES`."""
    if set(given) in map(set, COORDINATES):
        return
    like = max(COORDINATES, key=lambda line: len(set(line) & set(given)))
    missing = [name for name in like if name not in given]
    if not missing:
        raise origin.error(
            f"has {', '.join(name for name in given if name not in like)} beside "
            f"{', '.join(like)}, which give both directions alone; keep one of the two"
        )
    hint = ""
    if set(missing) <= {"phi_i", "phi_o"} and "delta_phi" not in given:
        hint = ", or delta_phi for phi_o - phi_i; in the plane of incidence, 180 throughout, with "
        hint += "theta_o below 0 on the light's side"
    raise origin.error(f"lacks the columns {', '.join(missing)}; add them{hint}")


def _find_channels(values, origin):
    """The channels, the columns of their values and those of their errors, of `values`: (channel,
    is an error) → number of a column."""
    found = {channel: number for (channel, error), number in values.items() if not error}
    errors = {channel: number for (channel, error), number in values.items() if error}
    channels = tuple(found)
    if not channels:
        raise origin.error("has no column of values; name it BRDF, or name three of them R, G, B")
    if set(channels) == set(RGB):
        channels = RGB
    elif channels != ("Y",) and not all(channel.endswith("nm") for channel in channels):
        raise origin.error(
            f"has values of {_list(channels)}, where R, G, B belong, or wavelengths such "
            "as 550nm, or one column BRDF; mend the names"
        )
    if errors and set(errors) != set(channels):
        raise origin.error(
            f"has standard errors of {_list(errors)} for the values of {_list(channels)}; give "
            "those of all, as R_error or BRDF_error, or none"
        )
    places = tuple(tuple(of[c] for c in channels if c in of) for of in (found, errors))
    return channels, *places


def _split(name):
    """The text of a column's name, and the unit in brackets behind it, in lower case, or None."""
    name = name.strip()
    bracket = max(name.rfind("["), name.rfind("("))
    if bracket < 0 or name[-1] not in "])":
        return name, None
    return name[:bracket], name[bracket + 1 : -1].strip().lower()


def _simplify(text):
    for letter, word in {"θ": "theta", "φ": "phi", "ϕ": "phi", "δ": "delta", "λ": "lambda"}.items():
        text = text.lower().replace(letter, word)
    return re.sub(r"[\s_-]", "", text)


KEYS = {_simplify(name): name for line in COORDINATES for name in line}
KEYS |= {_simplify(alias): name for alias, name in ALIASES.items()}


def _coordinate(text):
    """The coordinate that a column of this name has, or None."""
    return KEYS.get(_simplify(text))


def _value(text):
    """The channel of a column of this name and whether it is one of errors; None for a column of
    no values."""
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


def _cosines(text, is_error):
    """Whether a column of this name is of the BRDF times cos theta_o, as a set; empty for errors
    that do not say: they are as the values are."""
    simple = _simplify(text)
    if is_error and not re.match("(cc)?b[rs]df", simple):
        return set()
    return {simple.startswith("cc")}


def _units(coordinate):
    """The units that a column of this coordinate may state."""
    return (None,) if coordinate.startswith("w") else (None, *DEGREES, *RADIANS)


def _list(channels):
    return ", ".join("BRDF" if channel == "Y" else channel for channel in channels)[:60]


def _quote(name):
    return repr(name[:40])
