"""A virtual goniometer: which paths (`measuring`), through what (`specimen`), of which shape."""

from brdfkit.goniometer.measuring import measure as measure
