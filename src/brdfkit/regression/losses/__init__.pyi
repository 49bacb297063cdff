from .loss import Loss as Loss
from .named_losses import named as named
from .picture import Picture as Picture
