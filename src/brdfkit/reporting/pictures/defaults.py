"""What a report shows, unless one asks for others."""

MODELS = "ward", "ggx", "ggx+ggx"
SPP = 256  # samples per pixel
SIZE = 288  # side of a picture [pixels]
SCENE = "ball"

SMALLEST, LARGEST = 16, 1024  # sides of pictures [pixels]: of four large ones a page has some 20 MB
