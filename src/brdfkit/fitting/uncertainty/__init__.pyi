from .bootstrapping import Bootstrap as Bootstrap
from .bootstrapping import bootstrap as bootstrap
from .predicting import Prediction as Prediction
from .predicting import predict as predict
from .prediction_errors import PredictionError as PredictionError
from .prediction_errors import prediction_error as prediction_error
from .profiling import Profile as Profile
from .profiling import profile as profile
