"""Compares shadow techniques with exact, ray-traced shadows on a scene that the user chooses."""

from brdfkit.shadows.comparison.comparing import compare as compare
from brdfkit.shadows.comparison.comparison import ShadowComparison as ShadowComparison
from brdfkit.shadows.comparison.scores import Scores as Scores
