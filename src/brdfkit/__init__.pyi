from .auditing import Audit as Audit
from .auditing import audit as audit
from .checks import check as check
from .errors import BrdfkitError as BrdfkitError
from .fitting import Fit as Fit
from .fitting import losses as losses
from .goniometer import measure as measure
from .host.users_plugins import load_plugins as load_plugins
from .loading import load as load
from .loading import save as save
from .measured import Measured as Measured
from .model import Model as Model
from .model.labels import load_models as load_models
from .model.labels import models as models
from .plotting import plot as plot
from .rendering import Rendering as Rendering
from .rendering import render as render
from .rendering import render_scene as render_scene
from .verbs.compare import Comparison as Comparison
from .verbs.compare import compare as compare
from .verbs.convert import Conversion as Conversion
from .verbs.convert import convert as convert
from .verbs.evaluate import albedo as albedo
from .verbs.evaluate import evaluate as evaluate
from .verbs.fit import fit as fit

__version__: str
