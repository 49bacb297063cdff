"""Textures of a flat sample from photographs of it under known lights.

`capture/capture.py` is what was photographed, by a `capture/pinhole.py`, and `capture/checks.py`
what must hold of it; `capture/capture_file.py` a
folder, with `capture/cameras.py`, `capture/camera_from_corners.py` and `capture/toml_values.py`;
`capture/downsampling.py` makes pictures smaller, and `capture/observations.py` says what of them
each texel shows.

`maps/texel_parameters.py` are the numbers of a texel and how they make its radiances,
`maps/maps.py` those of all of them; `search/search.py` steps downhill, from `search/starts.py` and
`search/restarts.py`; `search/coarse_to_fine.py` does so for ever smaller texels, drawn to each
other by `search/smoothness.py`, and `search/fitting_maps.py` as `search/held_out.py` finds best.
`search/through_renderer.py` refines the maps by Mitsuba's pictures of them, and
`result/simulated_errors.py` says how certain they are. `svbrdf.py` runs these one after the other,
as `arguments.py` says; `maps/undetermined.py`, `maps/residuals.py`, `result/levelling.py` and
`result/notes.py` say what is left open, what is not explained, and what else one should know.

`result/result.py` is `Svbrdf`: `maps/prediction.py` shows it under any light, `maps/scene.py` in a
scene, `result/files.py` makes files and a `result/report.py` of it.
"""

from brdfkit.inverse.photographs.capture.capture import Capture as Capture
from brdfkit.inverse.photographs.capture.capture_file import load_capture as load_capture
from brdfkit.inverse.photographs.capture.pinhole import Pinhole as Pinhole
from brdfkit.inverse.photographs.result.result import Svbrdf as Svbrdf
from brdfkit.inverse.photographs.svbrdf import svbrdf as svbrdf
