"""Pictures of a ball under direct light: each pixel a sum of the BRDF at pairs of directions.

`lights.py` says what light comes from where, `half_vectors.py` where a material reflects it to. By
both, `normals.py` draws points of the ball, and `pixels.py` directions at each of them.
"""

from brdfkit.images.ball.lights import LIGHTS as LIGHTS
from brdfkit.images.ball.pixels import Pixels as Pixels
from brdfkit.images.ball.pixels import draw_pixels as draw_pixels
