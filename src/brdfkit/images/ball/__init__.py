"""Pictures of a ball under direct light, computed from a BRDF alone, without a renderer.

A pixel is a weighted sum of the BRDF at pairs of directions, so a fit can compare pictures of the
ball. `lights.py` defines the lights, `half_vectors.py` draws directions in which a BRDF is large.
With both, `normals.py` draws points of the ball, and `pixels.py` draws directions at each point.
`ball.py` draws the whole ball as a thumbnail.
"""

from brdfkit.images.ball.lights import LIGHTS as LIGHTS
from brdfkit.images.ball.pixels import Pixels as Pixels
from brdfkit.images.ball.pixels import draw_pixels as draw_pixels
