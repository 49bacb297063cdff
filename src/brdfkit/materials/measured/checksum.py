"""The checksum of a measurement: what it measured, whichever file and format it came from."""

import hashlib

import numpy as np


def checksum(data):
    """The SHA-256, in hexadecimal, of the channels' names, directions and values of a `Measured`.

    Numbers are hashed as 64 bits each, in C order; a table's directions follow from its shape.
    """
    digest = hashlib.sha256(repr(data.channels).encode())
    if data.is_table:
        digest.update(repr((data._table.shape, float(data._table.phi_d_period))).encode())
        arrays = [data._table.values]
    else:
        samples = data.samples
        arrays = [samples.wi, samples.wo, samples.values, samples.valid]
    for array in arrays:
        digest.update(np.ascontiguousarray(array, "<f8"))
    return digest.hexdigest()
