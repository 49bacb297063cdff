"""A `Volume` as dictionaries of Mitsuba's: its values, and these with a transfer function."""

from dataclasses import replace

import numpy as np

from brdfkit.core.jit.llvm import use_variant
from brdfkit.volumes.transfer.transfer_function import TransferFunction
from brdfkit.volumes.transfer.windows import scale_to_values


def scene_dict(volume, transfer):
    """See `Volume.scene_dict`."""
    use_variant()
    if transfer is None:
        return grid(volume, [volume.values])
    if not isinstance(transfer, TransferFunction):
        transfer = TransferFunction.load(transfer)
    if volume.unit and transfer.length_unit:
        transfer = transfer.per(volume.unit)
    transfer = scale_to_values(transfer, volume.values)
    if volume.labels and transfer.gradients is None:
        volume, transfer = numbered(volume, transfer)
    channels = [volume.values]
    if transfer.gradients is not None:
        channels.append(volume.gradient_magnitude)
    values = grid(volume, channels)
    return {
        "type": "transfer_function",
        "values": values,
        "transfer": transfer.to_json(),
        "to_world": values["to_world"],
    }


def numbered(volume, transfer):
    """The volume with its labels numbered 1, 2 ... in their order, and the function of the numbers.

    A renderer looks functions up in a table, in which labels of atlases, thousands or millions
    apart, would share a row.
    """
    labels, places = np.unique(volume.values, return_inverse=True)
    rgba = transfer([labels[0], *labels])
    values = np.int32(places.reshape(volume.values.shape) + 1)
    return replace(volume, values=values), replace(transfer, values=np.arange(len(rgba)), rgba=rgba)


def grid(volume, channels):
    """A gridvolume of some arrays (nz, ny, nx), where the volume is."""
    import mitsuba as mi

    return {
        "type": "gridvolume",
        "grid": mi.VolumeGrid(np.stack(channels, axis=-1).astype(np.float32)),
        "raw": True,
        "filter_type": "nearest" if volume.labels else "trilinear",
        "to_world": mi.ScalarTransform4f(volume.cube_to_world.tolist()),
    }
