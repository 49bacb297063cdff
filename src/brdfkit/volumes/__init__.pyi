from .loading import load as load
from .transfer.transfer_function import TransferFunction as TransferFunction
from .volume import Volume as Volume
