"""Short names for the array types in annotations.

Type checkers cannot follow the arrays of Dr.Jit, whose class depends on Mitsuba's variant, or the
objects of Mitsuba. Their names here stand for `Any`; they only tell the reader what a value is.
"""

from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike as ArrayLike
from numpy.typing import NDArray

FloatArray: TypeAlias = NDArray[np.floating[Any]]
IntArray: TypeAlias = NDArray[np.integer[Any]]
BoolArray: TypeAlias = NDArray[np.bool_]
AnyArray: TypeAlias = NDArray[Any]

# Arrays of Dr.Jit, in double precision or in that of Mitsuba's variant; or plain Python numbers
JitFloat: TypeAlias = Any
JitInt: TypeAlias = Any
JitMask: TypeAlias = Any
JitVector: TypeAlias = Any  # a vector of two or three components, each a JitFloat
JitColour: TypeAlias = Any  # a component for each colour channel of Mitsuba's variant

MitsubaModule: TypeAlias = Any  # the module `mitsuba`, after the choice of a variant
MitsubaObject: TypeAlias = Any  # an object of Mitsuba: a scene, a BSDF, an emitter ...
