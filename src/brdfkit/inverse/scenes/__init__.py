"""Estimates parameters of a scene from pictures of it, by differentiating the path tracer.

`refine.py` holds the public function, which runs the three parts below one after the other:

- `problem/` defines what is minimised: the scene, the parameters to search, the pictures to match,
  and the weight of each pixel.
- `search/` minimises it. `gauss_newton.py` handles up to 32 numbers, with a rendered picture of
  derivatives for each; `descent.py` handles the thousands of numbers of textures and volumes.
- `result/` estimates standard errors of the numbers and makes the `Refinement` that users receive.
"""

from brdfkit.inverse.scenes.refine import refine as refine
from brdfkit.inverse.scenes.result.refinement import Refinement as Refinement
