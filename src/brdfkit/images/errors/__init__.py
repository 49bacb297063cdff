"""Compares pictures with a reference by several metrics, and estimates the errors due to noise.

Pictures are arrays (height, width, 3) of linear sRGB; a mask (height, width) selects the pixels to
compare.
"""

from brdfkit.images.errors.image_errors import ImageErrors as ImageErrors
from brdfkit.images.errors.image_errors import compare_pictures as compare_pictures
