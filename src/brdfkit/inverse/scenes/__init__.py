"""Numbers of a scene found from pictures, by the derivatives of the path tracer.

`problem/scene.py` makes a scene of what is given, `problem/targets.py` reads the pictures,
`problem/masks.py` which of their pixels count, `problem/parameters.py` says what is searched, of
the `problem/scene_parameters.py` of the scene; `problem/parameter_facts.py` knows Mitsuba's own.
`problem/views.py` renders pictures, `search/forward_derivatives.py` their derivatives,
`search/normal_equations.py` makes of them E² to second order, and `problem/leverage.py` how certain
that is. On it `search/gauss_newton.py` steps, from the best of the `search/far_starts.py`. Of
thousands of numbers (`problem/tensors.py`) `search/backward_derivatives.py` has the derivatives;
`search/descent.py` goes along them, with some `problem/roughness.py` less. `result/second_look.py`
holds the end against the start and twice the samples. `refine.py` runs these one after the other;
`result/refinement.py` is what it returns, `result/conclusions.py` makes it,
`problem/unseen_parameters.py` says what no picture shows, and `result/residual_noise.py` whether
what is left is noise.
"""

from brdfkit.inverse.scenes.refine import refine as refine
from brdfkit.inverse.scenes.result.refinement import Refinement as Refinement
