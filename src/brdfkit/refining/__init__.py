"""Numbers of a scene found from pictures, by the derivatives of the path tracer.

`subject.py` makes a scene of what is given, `targets.py` reads the pictures, `masks.py` which of
their pixels count, `unknowns.py` says what is searched, of the `entries.py` of the scene;
`mitsuba_numbers.py` knows Mitsuba's own. `views.py` renders pictures, `derivatives.py` their
derivatives, `equations.py` makes of them E² to second order, and `leverage.py` how certain that is.
On it `gauss_newton.py` steps, from the best of the `far_starts.py`. Of thousands of numbers
(`tensors.py`) `backwards.py` has the derivatives; `descent.py` goes along them, with some
`roughness.py` less. `second_look.py` holds the end against the start and twice the samples.
`refine.py` runs these one after the other; `refinement.py` is what it returns,
`conclusions.py` makes it, `hidden.py` says what no picture shows, and `rest.py` whether what is
left is noise.
"""

from brdfkit.refining.refine import refine as refine
from brdfkit.refining.refinement import Refinement as Refinement
