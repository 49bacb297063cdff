"""Compares shadow techniques with exact shadows, on a scene of the user's."""

from brdfkit.shadows.comparison.comparing import compare as compare
from brdfkit.shadows.comparison.comparison import ShadowComparison as ShadowComparison
from brdfkit.shadows.comparison.scores import Scores as Scores
