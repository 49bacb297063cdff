"""The defaults of `report`, apart from other modules so that `brdfkit report --help` is instant."""

MODELS = "ward", "ggx", "ggx+ggx"
SPP = 256  # samples per pixel
SIZE = 288  # side of a picture [pixels]
SMALLEST_SIZE, LARGEST_SIZE = 16, 1024  # pixels: a page with four of the largest has about 20 MB
SCENE = "ball"
