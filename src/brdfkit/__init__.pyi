from .checks import check as check
from .comparing import compare as compare
from .errors import BrdfkitError as BrdfkitError
from .evaluating import evaluate as evaluate
from .fitting import Fit as Fit
from .fitting import fit as fit
from .fitting import losses as losses
from .formats import load as load
from .formats import save as save
from .measured import Measured as Measured
from .model import Model as Model
from .plotting import plot as plot
from .quadrature import albedo as albedo
from .registry import load_models as load_models
from .registry import models as models
from .rendering import Rendering as Rendering
from .rendering import render as render

__version__: str
