"""`rank`: which model suits a measured material, by its error where no fit saw it and its picture.

`held_out.py` draws the samples, cuts the directions into blocks and these into folds.
`cross_validation.py` fits a model to all folds but one, and takes its error on that one;
`appearance.py` looks at the fit to all of them. `ranking.py` does this for many models. `ranked.py`
makes rows of what came out, by the `ties.py` of their errors, `choice.py` chooses one and says why,
and `result.py` shows them all.
"""

from brdfkit.fitting.ranking.ranked import Ranked as Ranked
from brdfkit.fitting.ranking.ranking import rank as rank
from brdfkit.fitting.ranking.result import Ranking as Ranking
