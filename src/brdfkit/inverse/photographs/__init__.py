"""Estimates maps of a flat sample (an SVBRDF) from photographs of it under known lights.

The maps are textures of a BRDF model's parameters and of the surface normal. `svbrdf.py` holds the
public function, which runs the parts below one after the other:

- `capture/` reads photographs with the positions of cameras and lights, and collects the radiances
  of each texel (a pixel of the maps).
- `maps/` defines which numbers are searched for each texel, computes the radiance from them, and
  makes the maps a Mitsuba scene.
- `search/` fits these numbers: coarse maps first, then finer ones. At last it corrects them with
  Mitsuba's renderings of the maps.
- `result/` estimates standard errors, and makes the `Svbrdf` that users receive, its files and its
  report.
"""

from brdfkit.inverse.photographs.capture.capture import Capture as Capture
from brdfkit.inverse.photographs.capture.lights import Lights as Lights
from brdfkit.inverse.photographs.capture.load_photographs import (
    load_photographs as load_photographs,
)
from brdfkit.inverse.photographs.capture.object_capture import ObjectCapture as ObjectCapture
from brdfkit.inverse.photographs.capture.pinhole import Pinhole as Pinhole
from brdfkit.inverse.photographs.objects.object_maps import ObjectMaps as ObjectMaps
from brdfkit.inverse.photographs.result.result import Svbrdf as Svbrdf
from brdfkit.inverse.photographs.svbrdf import svbrdf as svbrdf
