"""The building blocks of a BRDF model, for authors of models.

`model.py` has the class `Model`, `parameters.py` its parameters and options, `lobes.py` its terms
and how their directions are drawn, `microfacet.py` distributions of normals, `fresnel.py` the
microfacet models with Schlick's Fresnel reflectance, and `numerics.py` functions that are accurate
in single precision. The other files serve all models: `labels.py` finds a model by its label,
`weights.py` reads weights of any channels, and `evaluation.py` computes values of the BRDF.
"""

from brdfkit.model.model import Model as Model
from brdfkit.model.parameters import Option as Option
from brdfkit.model.parameters import Parameter as Parameter
from brdfkit.model.parameters import anisotropy as anisotropy
from brdfkit.model.parameters import follows as follows
from brdfkit.model.parameters import option as option
from brdfkit.model.parameters import shape as shape
from brdfkit.model.parameters import weight as weight
