"""Textures of a flat sample from photographs of it under known lights.

`capture.py` is what was photographed, `capture_file.py` reads its folder, `pinhole.py` is the
camera; `observations.py` says what of it each texel shows. `numbers.py` are the numbers of a texel
and how they make its radiances; `search.py` steps downhill, from `starts.py`; `fitting_maps.py`
goes from coarse to fine. `svbrdf.py` runs these one after the other, `open_numbers.py` says what is
left open, and `result.py` is `Svbrdf`: `prediction.py` shows it under any light, `in_mitsuba.py` in
a scene, `writing.py` makes files and a `report.py` of it.
"""

from brdfkit.photographs.capture import Capture as Capture
from brdfkit.photographs.capture_file import load_capture as load_capture
from brdfkit.photographs.pinhole import Pinhole as Pinhole
from brdfkit.photographs.result import Svbrdf as Svbrdf
from brdfkit.photographs.svbrdf import svbrdf as svbrdf
