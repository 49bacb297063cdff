from .comparison.comparing import compare as compare
from .comparison.comparison import ShadowComparison as ShadowComparison
from .comparison.scores import Scores as Scores
