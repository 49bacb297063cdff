"""The building blocks of a BRDF model: all that the author of a model reads.

`model.py` has the class `Model`, `parameters.py` what it declares, `lobes.py` its terms and how
their directions are drawn, `microfacet.py` distributions of normals, `fresnel.py` the models of
facets with Schlick's F, and `numerics.py` accurate functions. The other files serve all models:
`labels.py` finds a model by its label, `weights.py` reads weights of any channels, and
`evaluation.py` computes values.
"""

from brdfkit.model.model import Model as Model
from brdfkit.model.parameters import Option as Option
from brdfkit.model.parameters import Parameter as Parameter
from brdfkit.model.parameters import follows as follows
from brdfkit.model.parameters import option as option
from brdfkit.model.parameters import shape as shape
from brdfkit.model.parameters import weight as weight
