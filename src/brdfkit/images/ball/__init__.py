"""Pictures of a ball under direct light; each pixel is a sum of the BRDF at pairs of directions.

`lights.py` defines the lights, and `half_vectors.py` the directions to which a material reflects.
With both, `normals.py` draws points of the ball, and `pixels.py` draws directions at each point.
"""

from brdfkit.images.ball.lights import LIGHTS as LIGHTS
from brdfkit.images.ball.pixels import Pixels as Pixels
from brdfkit.images.ball.pixels import draw_pixels as draw_pixels
