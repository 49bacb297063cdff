"""The compass: a map that shows which way a program turns, mirrors and shifts its environments.

Every side of the world has a colour of its own and its name in it, legible from inside: +x red and
-x cyan, +y green and -y magenta, +z blue and -z yellow. The first column of the picture is white
and the last black, so that the seam between them is seen to half a pixel.
"""

from pathlib import Path

import numpy as np

from brdfkit.lighting.environments.conventions import convention
from brdfkit.lighting.environments.resampling import resample

COLOURS = {
    "+x": (0.8, 0.1, 0.1),
    "-x": (0.1, 0.7, 0.7),
    "+y": (0.1, 0.65, 0.1),
    "-y": (0.7, 0.1, 0.7),
    "+z": (0.12, 0.2, 0.9),
    "-z": (0.8, 0.7, 0.1),
}
MARK = 3.0  # radiance of the white column and of the letters
FACE = 256  # pixels of a side of the cube on which they are drawn


def compass(height=128):
    """The compass (height, 2 height, 3) in the convention of Mitsuba.

    >>> compass(64)[32, 32].round(1).tolist()    # a quarter from the left is +x
    [0.8, 0.1, 0.1]
    """
    # right, left, up, down, ahead, back of somebody who looks along +z
    faces = np.concatenate([_face(side) for side in ("-x", "+x", "+y", "-y", "+z", "-z")], axis=1)
    found = resample(faces, convention("strip:-x+y+z"), convention("mitsuba"), height)
    found[:, 0], found[:, -1] = MARK, 0
    return found


def _face(side):
    import matplotlib as mpl
    from PIL import Image, ImageDraw, ImageFont

    picture = Image.new("L", (FACE, FACE))
    file = Path(mpl.get_data_path(), "fonts/ttf/DejaVuSans-Bold.ttf")  # comes with matplotlib
    font = ImageFont.truetype(str(file), FACE // 3)
    name = side.replace("-", "\N{MINUS SIGN}")
    ImageDraw.Draw(picture).text((FACE / 2, FACE / 2), name, 255, font, "mm")
    share = np.asarray(picture)[..., None] / 255
    return (1 - share) * np.array(COLOURS[side]) + share * MARK
