"""`Source`: a file to read, with functions that parse its text and report errors about it."""

from codecs import BOM_UTF16_BE, BOM_UTF16_LE
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from brdfkit.core.array_types import ArrayLike, BoolArray, FloatArray
from brdfkit.core.colours import RGB
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.files import COMPRESSED, read_bytes
from brdfkit.core.geometry.directions import from_angles
from brdfkit.materials.measured import Measured

# Largest absolute values [rad] of the angles theta and phi of one direction, then of the other
SPHERICAL = (np.pi / 2, 2 * np.pi, np.pi / 2, 2 * np.pi)
ANGLE_TOLERANCE = 1e-3  # rad; angles may exceed a limit by this much: files round 90° to 1.5708
REMEDY = "mend the line or fetch the file again"


@dataclass(frozen=True)
class Source:
    """A file, with its content in memory, that the reader of a file format gets.

    `path`: path of the file; `sample`: text behind '#' in the path that the user gave, which names
    one of several materials, or None; `data`: content of the file as decompressed bytes.

    >>> Source(Path("paint/copper.astm.xz"), None, b"...").name
    'copper'
    """

    path: Path
    sample: str | None
    data: bytes = field(repr=False)

    @property
    def suffix(self) -> str:
        """The suffix that names the format, in lower case, without .gz or .xz."""
        return find_format_suffix(self.path)

    @property
    def name(self) -> str:
        """The file's name without its suffixes."""
        name = _strip_compression_suffix(self.path).name
        return name[: -len(self.suffix)] if self.suffix else name

    @cached_property
    def lines(self) -> list[tuple[int, str]]:
        """The lines with data, stripped of blanks, as pairs (number of the line from 1, text).

        Blank lines, and comments that begin with '#', are left out.
        """
        return [(n, line.strip()) for n, line in self.whole_lines]

    @cached_property
    def whole_lines(self) -> list[tuple[int, str]]:
        """The lines with data, as in `lines`, but not stripped, because tabs may be columns."""
        numbered = enumerate(self._all_lines, 1)
        return [(n, line) for n, line in numbered if line.strip()[:1] not in ("", "#")]

    @cached_property
    def comments(self) -> list[str]:
        """The comments: the texts of all lines that begin with '#', without the '#'."""
        stripped = (line.strip() for line in self._all_lines)
        return [line.strip("# ") for line in stripped if line.startswith("#")]

    @property
    def _all_lines(self) -> list[str]:
        """All lines of the file as text, decoded from UTF-8, or UTF-16 with a byte-order mark."""
        # Spreadsheets write UTF-16 where the user chooses to save "Unicode text"
        wide = self.data.startswith((BOM_UTF16_LE, BOM_UTF16_BE))
        text = self.data.decode("utf-16" if wide else "utf-8-sig", errors="replace")
        return text.replace("\r\n", "\n").replace("\r", "\n").split("\n")

    def error(self, problem: str) -> BrdfkitError:
        """Return a `BrdfkitError` that begins with this file's path.

        `problem` says what is wrong and what to do, without a full stop.
        """
        return BrdfkitError(f"{self.path}: {problem}.")

    def open_sibling(self, name: str) -> "Source":
        """Read the file `name` in the same folder, which may be compressed, as a `Source`."""
        for suffix in ("", *COMPRESSED):
            path = self.path.with_name(name + suffix)
            if path.exists():
                return Source(path, None, read_bytes(path))
        raise self.error(f"needs {name} beside it; put the two in one folder")

    def parse_rows(
        self, rows: Sequence[tuple[int, str]], columns: int, delimiter: str | None = None
    ) -> FloatArray:
        """Parse the numbers (n, columns) in `rows`, which are pairs (number of the line, text).

        The numbers are separated by blanks, or by the `delimiter`. Raises `BrdfkitError` where
        there is no row, and for a row with text or with another number of columns.
        """
        if not rows:
            raise self.error("has no rows behind its header; fetch the file again")
        return np.array([self.parse_numbers(n, line.split(delimiter), columns) for n, line in rows])

    def parse_numbers(
        self, line: int, fields: Sequence[str], count: int | None = None
    ) -> list[float]:
        """Parse the texts `fields` of line number `line` as floats.

        Raises `BrdfkitError` where one is no number, or, unless `count` is None, where there are
        not `count` of them.
        """
        if count is not None:
            self.require_column_count(line, fields, count)
        numbers = []
        for text in fields:
            try:
                numbers.append(_parse_number(text))
            except ValueError:
                raise self.error(
                    f"line {line} has {text[:40]!r} where a number belongs; {REMEDY}"
                ) from None
        return numbers

    def require_column_count(self, line: int, fields: Sequence[str], count: int) -> None:
        """Raise `BrdfkitError` unless there are `count` `fields` in line number `line`."""
        if len(fields) != count:
            raise self.error(
                f"line {line} has {len(fields)} columns where {count} belong (cut short?); {REMEDY}"
            )

    def make_measured_from_angles(
        self, lines: Sequence[int], angles: ArrayLike, values: ArrayLike, **details: Any
    ) -> Measured:
        """Make a `Measured` of this file from `values` (n, channels) at `angles` (n, 4) [rad].

        The angles are theta_i, phi_i, theta_o, phi_o. Errors about them name their `lines` (n,).
        `details` are further arguments of `make_measured_from_directions`.
        """
        angles = np.array(angles, float)
        self.require_radians(lines, angles, SPHERICAL)
        wi, wo = from_angles(*angles[:, :2].T), from_angles(*angles[:, 2:].T)
        return self.make_measured_from_directions(wi, wo, values, **details)

    def make_measured_from_directions(
        self,
        wi: FloatArray,
        wo: FloatArray,
        values: ArrayLike,
        valid: BoolArray | bool = True,
        channels: Sequence[str] = RGB,
        name: str | None = None,
        info: Mapping[str, str] | None = None,
        standard_error: FloatArray | None = None,
        **details: Any,
    ) -> Measured:
        """Make a `Measured` of this file from samples, as `Measured.from_samples` does.

        Its name is by default the file's. Values that are not finite are masked, and a note in
        `info` counts them.
        """
        values = np.array(values, float)
        finite = np.isfinite(values).all(axis=1)
        if standard_error is not None:
            finite &= np.isfinite(standard_error).all(axis=1)
            details["standard_error"] = standard_error
        notes, name = dict(info or {}), name or self.name
        # Count the rows that are not finite, but only those that the reader has not masked itself
        if (masked := ~finite & valid).any():
            notes["not finite"] = f"{masked.sum():,} of {len(finite):,} rows, masked"
        try:
            return Measured.from_samples(
                wi,
                wo,
                values,
                valid=finite & valid,
                channels=channels,
                name=name,
                info=notes,
                **details,
            )
        except BrdfkitError:
            raise self.error(
                "no row is a valid measurement (masked, not finite or at the horizon); "
                "fetch the file again"
            ) from None

    def require_radians(
        self, lines: Sequence[int], angles: FloatArray, limits: Sequence[float]
    ) -> None:
        """Raise `BrdfkitError` where the `angles` (n, k) exceed the `limits` (k,) [rad].

        They are then probably in degrees. Signs do not matter. `lines` (n,) are the numbers of the
        lines with the angles.
        """
        limit = np.array(limits) + ANGLE_TOLERANCE
        wrong = ~(np.abs(angles) <= limit)  # True also for NaN, which a test with > would accept
        if wrong.any():
            row, column = np.argwhere(wrong)[0]
            raise self.error(
                f"line {lines[row]} has the angle {angles[row, column]:g} where at most "
                f"{limit[column]:.3f} rad belongs; convert degrees to radians or mend the line"
            )


def find_format_suffix(path: Path) -> str:
    """Return the suffix of a path that names its format: in lower case, without .gz or .xz.

    >>> find_format_suffix(Path("copper.astm.xz"))
    '.astm'
    """
    return _strip_compression_suffix(path).suffix.lower()


def _strip_compression_suffix(path: Path) -> Path:
    return path.with_suffix("") if path.suffix.lower() in COMPRESSED else path


def _parse_number(text: str) -> float:
    if "_" in text:  # Python reads 1_0 as the number ten, but in a file it is an error
        raise ValueError
    return float(text)
