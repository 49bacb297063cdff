"""Compares shadow techniques on a user's scene with exact shadows."""

from brdfkit.shadows.comparison.comparing import compare as compare
from brdfkit.shadows.comparison.comparison import ShadowComparison as ShadowComparison
from brdfkit.shadows.comparison.scores import Scores as Scores
