"""Volumes: values on a grid of voxels, from files or made, and what they mean to light.

`volume.py` is one, `reconstruction.py` what it is between its voxels, `reducing.py` fewer voxels of
it; `loading.py` finds it in a file (`formats/`) or makes it (`made/`). `transfer_function.py`:
colour and extinction of its values, with `piecewise.py`, `opacity.py`, `colour_maps.py`, and in
files `stored.py`, `slicer_presets.py`, `presets/`. `summary.py` is what `brdfkit info VOLUME`
tells, by `histograms.py`, `report.py` and `picture.py`. For renderers `transfer_lookup.py` is the
function's texture, `preintegration.py` its means between two values, for steps that would jump over
what it has (`voxel_steps.py`), and `block_bounds.py` bounds of it; `majorants.py` bounds the
extinction, and `tracking.py` finds where light collides. Rays are helped by `along_ray.py`,
`largest_value.py` and `first_crossing.py`, level sets by `normals.py` and `surface_light.py`. Paths
of light go through a `medium.py`, whose bounds are those of `extinction_bounds.py`, turn at a
`vertex.py`, and come from `emitters.py`.
"""

from brdfkit.volumes.loading import load_volume as load_volume
from brdfkit.volumes.transfer_function import TransferFunction as TransferFunction
from brdfkit.volumes.volume import Volume as Volume
