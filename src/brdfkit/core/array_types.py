"""Short names for the arrays that functions take and return, for their annotations.

Neither Dr.Jit's arrays, whose class depends on Mitsuba's variant, nor Mitsuba's objects have
types that a checker could follow through a formula. The names for them tell the reader alone.
"""

from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike as ArrayLike
from numpy.typing import NDArray

FloatArray: TypeAlias = NDArray[np.floating[Any]]
IntArray: TypeAlias = NDArray[np.integer[Any]]
BoolArray: TypeAlias = NDArray[np.bool_]
AnyArray: TypeAlias = NDArray[Any]

# Values of Dr.Jit in any variant, or of core/jit/double_precision.py, or plain Python numbers
JitFloat: TypeAlias = Any
JitInt: TypeAlias = Any
JitMask: TypeAlias = Any
JitVector: TypeAlias = Any  # two or three components, each a JitFloat
JitColour: TypeAlias = Any  # one component for each channel of the variant

MitsubaModule: TypeAlias = Any  # the module `mitsuba`, with a variant set
MitsubaObject: TypeAlias = Any  # a scene, a BSDF, an emitter ...
