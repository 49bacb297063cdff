"""A laboratory of shadows: techniques on a user's scene, scored against exact shadows."""

from brdfkit.shadows.comparing import compare as compare
from brdfkit.shadows.comparison import ShadowComparison as ShadowComparison
from brdfkit.shadows.scores import Scores as Scores
