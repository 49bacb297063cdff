"""`rank`: which models suit a measured material, by cross-validation and by pictures of their fits.

`held_out.py` divides samples into blocks of directions, and blocks into folds.
`cross_validation.py` fits a model to all folds but one and computes its error on that one;
`appearance.py` compares the fit to all samples with the material. `ranking.py` does this for many
models. `ranked.py` sorts the results into rows, and `ties.py` decides which errors are tied.
`choice.py` chooses the recommended model, and `result.py` prints the ranking.
"""

from brdfkit.fitting.ranking.ranked import Ranked as Ranked
from brdfkit.fitting.ranking.ranking import rank as rank
from brdfkit.fitting.ranking.result import Ranking as Ranking
