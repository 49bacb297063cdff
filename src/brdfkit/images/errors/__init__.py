"""Compares pictures with a reference by several metrics, each beside its noise floor.

Pictures are arrays (height, width, 3) of linear sRGB; a mask (height, width) says which pixels
count.
"""

from brdfkit.images.errors.image_errors import ImageErrors as ImageErrors
from brdfkit.images.errors.image_errors import compare_pictures as compare_pictures
