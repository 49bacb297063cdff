"""Textures of a flat sample from photographs of it under known lights.

`capture.py` is what was photographed, by a `pinhole.py`, and `capture_checks.py` what must hold of
it; `to_arrays.py` reads lists of numbers, `capture_file.py` a folder, with `cameras_of_file.py`,
`camera_from_corners.py` and `toml_values.py`; `shrinking.py` makes pictures smaller, and
`observations.py` says what of them each texel shows.

`numbers.py` are the numbers of a texel and how they make its radiances, `maps.py` those of all of
them; `search.py` steps downhill, from `starts.py` and `restarts.py`; `coarse_to_fine.py` does so
for ever smaller texels, drawn to each other by `strengths.py`, and `fitting_maps.py` as
`held_out.py` finds best. `through_renderer.py` refines the maps by Mitsuba's pictures of them, and
`simulated_errors.py` says how certain they are. `svbrdf.py` runs these one after the other, as
`asked.py` says; `open_numbers.py`, `misfit.py`, `flatness.py` and `notes.py` say what is left
open, what is not explained, and what else one should know.

`result.py` is `Svbrdf`: `prediction.py` shows it under any light, `in_mitsuba.py` in a scene,
`writing.py` makes files and a `report.py` of it.
"""

from brdfkit.photographs.capture import Capture as Capture
from brdfkit.photographs.capture_file import load_capture as load_capture
from brdfkit.photographs.pinhole import Pinhole as Pinhole
from brdfkit.photographs.result import Svbrdf as Svbrdf
from brdfkit.photographs.svbrdf import svbrdf as svbrdf
