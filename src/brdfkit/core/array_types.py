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

# Numbers of Dr.Jit in a variant or in double precision (core/jit), or plain Python numbers
JitFloat: TypeAlias = Any
JitInt: TypeAlias = Any
JitMask: TypeAlias = Any
JitVector: TypeAlias = Any  # two or three components, each a JitFloat
JitColour: TypeAlias = Any  # one component for each channel of the variant

MitsubaModule: TypeAlias = Any  # the module `mitsuba`, with a variant set
MitsubaObject: TypeAlias = Any  # a scene, a BSDF, an emitter ...
