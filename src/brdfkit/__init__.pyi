from .checks import check as check
from .comparing import compare as compare
from .errors import BrdfkitError as BrdfkitError
from .evaluating import evaluate as evaluate
from .fitting import Fit as Fit
from .fitting import fit as fit
from .fitting import losses as losses
from .formats import load as load
from .formats import save as save
from .geometry.quadrature import albedo as albedo
from .measured import Measured as Measured
from .model import Model as Model
from .model.labels import load_models as load_models
from .model.labels import models as models
from .plotting import plot as plot
from .rendering import Rendering as Rendering
from .rendering import render as render

__version__: str
