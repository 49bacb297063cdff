"""Conversion of a `Volume`, with or without a transfer function, to a dictionary for Mitsuba."""

from dataclasses import replace
from typing import Any

import numpy as np

from brdfkit.core.array_types import AnyArray
from brdfkit.core.jit.llvm import use_variant
from brdfkit.volumes.transfer.transfer_function import TransferFunction, TransferLike
from brdfkit.volumes.transfer.windows import scale_transfer_to_values

Volume = Any  # the class in `volume.py`; its import would be circular


def make_scene_dict(volume: Volume, transfer: TransferLike | None) -> dict[str, Any]:
    """Return a volume as a dictionary for `mitsuba.load_dict`, with a transfer function if given.

    See `Volume.scene_dict`.
    """
    use_variant()
    if transfer is None:
        return _make_grid_dict(volume, [volume.values])
    if not isinstance(transfer, TransferFunction):
        transfer = TransferFunction.load(transfer)
    if volume.unit and transfer.length_unit:
        transfer = transfer.per(volume.unit)
    transfer = scale_transfer_to_values(transfer, volume.values)
    if volume.labels and transfer.gradients is None:
        volume, transfer = _renumber_labels(volume, transfer)
    channels = [volume.values]
    if transfer.gradients is not None:
        channels.append(volume.gradient_magnitude)
    values = _make_grid_dict(volume, channels)
    return {
        "type": "transfer_function",
        "values": values,
        "transfer": transfer.to_json(),
        "to_world": values["to_world"],
    }


def _renumber_labels(volume: Volume, transfer: TransferFunction) -> tuple[Volume, TransferFunction]:
    """Replace the labels of a volume by 1, 2 ..., and the values of the transfer function likewise.

    Renderers look transfer functions up in a table over values. If labels were thousands or
    millions apart, as in atlases of the brain, several would share an entry of the table.
    """
    labels, places = np.unique(volume.values, return_inverse=True)
    rgba = transfer([labels[0], *labels])
    values = np.int32(places.reshape(volume.values.shape) + 1)
    return replace(volume, values=values), replace(transfer, values=np.arange(len(rgba)), rgba=rgba)


def _make_grid_dict(volume: Volume, channels: list[AnyArray]) -> dict[str, Any]:
    """Return the dictionary of a Mitsuba gridvolume with the transform and filter of `volume`.

    Its channels are arrays (nz, ny, nx).
    """
    import mitsuba as mi

    grid = channels[0][..., None]
    if len(channels) > 1:
        grid = np.stack(channels, axis=-1, dtype=np.float32, casting="same_kind")
    return {
        "type": "gridvolume",
        "grid": mi.VolumeGrid(grid.astype(np.float32, copy=False)),
        "raw": True,
        "filter_type": "nearest" if volume.labels else "trilinear",
        "to_world": mi.ScalarTransform4f(volume.cube_to_world.tolist()),
    }
