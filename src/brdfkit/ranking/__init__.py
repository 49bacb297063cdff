"""`rank`: which model suits a measured material, by its error at directions that no fit saw.

`held_out.py` draws the samples, cuts the directions into blocks and these into folds.
`cross_validation.py` fits a model to all folds but one, and takes its error on that one.
`ranking.py` does this for many models; `result.py` compares them, and says it in words.
"""

from brdfkit.ranking.ranking import rank as rank
from brdfkit.ranking.result import Ranked as Ranked
from brdfkit.ranking.result import Ranking as Ranking
