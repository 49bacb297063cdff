"""Defines the defaults of `report`.

The file imports nothing, so that `brdfkit report --help` does not have to wait for other modules.
"""

MODELS = "ward", "ggx", "ggx+ggx"
SPP = 256  # samples per pixel
SIZE = 288  # side of the square pictures [pixels]
# Limits of the side of a picture [pixels]; a page with four of the largest has about 20 MB
SMALLEST_SIZE, LARGEST_SIZE = 16, 1024
SCENE = "ball"
