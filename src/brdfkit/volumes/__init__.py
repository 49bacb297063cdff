"""Volumes: values on a grid of voxels, from files or made, and what they mean to light.

`volume.py` is one, `rays/reconstruction.py` what it is between its voxels, `reducing.py` fewer
voxels of it; `loading.py` finds it in a file (`formats/`) or makes it (`made/`).
`transfer/transfer_function.py`: colour and extinction of its values, with `transfer/piecewise.py`,
`transfer/opacity.py`, `transfer/colour_maps.py`, and in files `transfer/files.py`,
`transfer/slicer_presets.py`, `presets/`. `summary/summary.py` is what `brdfkit info VOLUME` tells,
by `summary/histograms.py`, `summary/report.py` and `summary/picture.py`. For renderers
`transfer/lookup.py` is the function's texture, `transfer/preintegration.py` its means between two
values, for steps that would jump over what it has (`rays/voxel_steps.py`), and
`transfer/block_bounds.py` bounds of it; `light/majorants.py` bounds the extinction, and
`light/tracking.py` finds where light collides. Rays are helped by `rays/along_ray.py`,
`rays/largest_value.py` and `rays/find_first_crossing.py`, level sets by `rays/normals.py` and
`light/surface_light.py`. Paths of light go through a `light/medium.py`, whose bounds are those of
`light/extinction_bounds.py`, turn at a `light/vertex.py`, and come from `light/emitters.py`.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
