"""Numbers of a scene found from pictures, by the derivatives of the path tracer.

`subject.py` makes a scene of what is given, `targets.py` reads the pictures, `masks.py` which of
their pixels count, `unknowns.py` says what is searched. `views.py` renders pictures and their
derivatives, `equations.py` makes of them E² to second order, and `leverage.py` how certain that is.
On it `gauss_newton.py` steps, from the best of the `far_starts.py`. Of thousands of numbers
(`tensors.py`) `backwards.py` has the derivatives; `descent.py` goes along them, with some
`smoothness.py`. `refine.py` runs these one after the other; `refinement.py` is what it returns,
`conclusions.py` makes it, and `hidden.py` says what no picture shows.
"""

from brdfkit.refining.refine import refine as refine
from brdfkit.refining.refinement import Refinement as Refinement
