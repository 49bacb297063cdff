"""The pictures of a report, unless one asks for others."""

SPP = 256  # samples per pixel
SIZE = 288  # side [pixels]
