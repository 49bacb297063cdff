"""Transfer function: a volume that maps the values of another volume to extinctions and colours.

    values v, and where the function has them, gradient magnitudes g → RGB, A
    output = extinction: σ_t = extinction · A(v, g)        output = colour: RGB(v, g)

A is the opacity in [0, 1], and σ_t the extinction per unit of length. `transfer` is the name of a
preset, such as "ct_bone", a file that `TransferFunction.save` wrote, or the text of such a file,
from `to_json()`. A preset that is defined on shares of the range of values, such as those for MRI,
is scaled to the smallest and largest value. `values` is a gridvolume with `"raw": True`. If the
function depends on gradient magnitudes, these are the second channel of the grid
(`Volume.gradient_magnitude`). A grid of labels needs `"filter_type": "nearest"`. Values are
interpolated before they are looked up.

`Volume.scene_dict(transfer)` writes all of this. For Mitsuba's own integrators, a scan is the
medium

    {"type": "heterogeneous", "albedo": {..., "output": "colour"}, "sigma_t": {...}}

where both are volumes of this type, with the same `values`, within a cube of the same `to_world`.
By default this cube is the box of the values; an oblique grid needs `Volume.cube_to_world` in both.
`clip_low` and `clip_high` are two corners, by default (0, 0, 0) and (1, 1, 1), of the part of the
cube that brdfkit's integrators show: a clipping box opens a head or a gearbox.

Integrators of brdfkit take one such volume and look up σ_t and RGB at once. Derivatives flow to the
function's table, to its extinction and to the values.

[Lesar 2018, chapter 6]; [Kniss et al. 2002]. RGB is linear sRGB; in spectral variants it becomes
the sum of three basis spectra [Mallett & Yuksel 2019], times D65 if it is an emission.
"""

from collections.abc import Callable, Sequence
from functools import cached_property
from typing import Any

import drjit as dr
import numpy as np

from brdfkit.core.array_types import (
    FloatArray,
    JitColour,
    JitFloat,
    JitMask,
    JitVector,
    MitsubaModule,
    MitsubaObject,
)
from brdfkit.core.errors import BrdfkitError
from brdfkit.mitsuba_bridge.channels import make_rgb_emission, make_rgb_spectrum
from brdfkit.mitsuba_bridge.properties.conversions import resolve_file
from brdfkit.mitsuba_bridge.properties.declarations import (
    declare_choice,
    declare_point,
    declare_text,
    declare_volume,
    derive_plugin,
)
from brdfkit.mitsuba_bridge.registration.registering import require_vectorised
from brdfkit.volumes.light.majorants import read_grid_values
from brdfkit.volumes.rays.voxel_steps import is_trilinear, rms_neighbour_difference
from brdfkit.volumes.transfer import files
from brdfkit.volumes.transfer.block_bounds import bound_piecewise_linear, find_block_ranges
from brdfkit.volumes.transfer.lookup import TransferLookup
from brdfkit.volumes.transfer.preintegration import has_narrow_peaks
from brdfkit.volumes.transfer.transfer_function import TransferFunction
from brdfkit.volumes.transfer.windows import scale_transfer_to_values

CHANNELS = {1: "values alone", 2: "values and gradient magnitudes"}
PARAMETERS = {
    "values": declare_volume(0.0, "the values to look up", least=-np.inf),
    "transfer": declare_text("ct_bone", "the function: a preset, a file, or its text"),
    "clip_low": declare_point((0, 0, 0), "lowest corner of the visible part, in the unit cube"),
    "clip_high": declare_point((1, 1, 1), "highest corner of the visible part, in the unit cube"),
    "output": declare_choice(("extinction", "colour"), "what Mitsuba's media and textures read"),
}


def define(mi: MitsubaModule) -> type:
    """Return the plugin's class for Mitsuba's current variant: a `mi.Volume`."""
    Base: MitsubaObject = derive_plugin(mi.Volume, PARAMETERS)

    class TransferFunctionVolume(Base):
        def __init__(self, props: MitsubaObject) -> None:
            require_vectorised("transfer_function")
            values = props.get("values", 0)
            if "to_world" not in props and isinstance(values, mi.Volume):
                props["to_world"] = find_box_transform(mi, values)
            super().__init__(props)
            to_world = np.array(props.get("to_world", mi.ScalarTransform4f()).matrix)
            self.to_local = mi.Transform4f(np.linalg.inv(to_world))
            dr.make_opaque(self.to_local)
            self.function = read_transfer_function(self.transfer, self.values)
            self.lookup = TransferLookup(self.function)

        def traverse(self, callback: MitsubaObject) -> None:
            super().traverse(callback)
            callback.put("table", self.lookup.table, mi.ParamFlags.Differentiable)
            callback.put("extinction", self.lookup.extinction, mi.ParamFlags.Differentiable)

        def parameters_changed(self, keys: Sequence[str] = ()) -> None:
            super().parameters_changed(keys)
            if keys and not {"table", "extinction", "values"} & set(keys):
                return  # only the clipping box
            self.lookup.recompute_texture()
            self.__dict__.pop("majorants", None)
            if not keys or "values" in keys:
                self.__dict__.pop("block_ranges", None)

        def eval_extinction_and_colour(
            self, it: MitsubaObject, active: JitMask = True
        ) -> tuple[JitFloat, JitColour]:
            """Return the extinction σ_t at the point `it`, and the colour RGB in linear sRGB."""
            rgb, a = self.eval_rgba(it, active)
            return self.lookup.extinction * a, rgb

        def misses_peaks(self, steps: int) -> bool:
            """Return whether a ray cut into `steps` parts would step over peaks of the function.

            If so, integrators should use `average_extinction_and_colour`, which includes the peaks.
            The result is False for functions of labels or gradient magnitudes, which have no
            averages.
            """
            data = read_grid_values(self.values)
            if data is None or self.function.gradients is not None:
                return False
            low, high = self.function.range
            voxels_per_step = max(1, max(data.shape) / steps)
            # The change of the values within a step, and the number of table entries that it covers
            change = rms_neighbour_difference(data) * voxels_per_step
            reach = change / (high - low) * self.lookup.integrals.steps
            thin = has_narrow_peaks(np.array(self.lookup.table), reach)
            return thin and is_trilinear(self.values, data, self.to_local)

        def eval_integrals(self, it: MitsubaObject, active: JitMask = True) -> JitVector:
            """Return the integrals of the transfer function from its lowest value to that at `it`.

            `average_extinction_and_colour` takes them at both ends of a part of a ray. The function
            must depend on values alone.
            """
            return self.lookup.integrate_to_value(self.values.eval_1(it, active))

        def average_extinction_and_colour(
            self, front: JitVector, back: JitVector
        ) -> tuple[JitFloat, JitColour]:
            """Return the means of σ_t, and of σ_t times RGB, between two values of the volume.

            `front` and `back` are the function's integrals up to these values.
            """
            rgb, a = self.lookup.mean_between(front, back)
            return self.lookup.extinction * a, self.lookup.extinction * rgb

        def eval_rgba(
            self, it: MitsubaObject, active: JitMask = True
        ) -> tuple[JitVector, JitFloat]:
            """Return the colour RGB in linear sRGB and the opacity A at the point `it`."""
            return self.lookup(self.eval_arguments(it, active), active)

        def eval_arguments(self, it: MitsubaObject, active: JitMask = True) -> Sequence[JitFloat]:
            """Return the value at a point, and its gradient magnitude if the function needs it."""
            if self.function.gradients is None:
                return [self.values.eval_1(it, active)]
            return self.values.eval_n(it, active)

        def eval_1(self, it: MitsubaObject, active: JitMask = True) -> JitFloat:
            sigma, rgb = self.eval_extinction_and_colour(it, active)
            return sigma if self.output == "extinction" else mi.luminance(rgb)

        def eval(self, it: MitsubaObject, active: JitMask = True) -> JitColour:
            sigma, rgb = self.eval_extinction_and_colour(it, active)
            if self.output == "extinction":
                return mi.UnpolarizedSpectrum(sigma)
            return self.spectrum(rgb, it)

        def max(self) -> float:
            rows = self.lookup.reduce_table_to_values()
            if self.output == "colour":
                return float(rows[:, :3].max())
            return float(self.majorants.max())

        def resolution(self) -> JitVector:
            return self.values.resolution()

        @cached_property
        def spectrum(self) -> Callable[..., JitColour]:
            """The function (RGB, point) → spectrum for reflectances, or for emission."""
            emits = self.function.colour == "emission"
            return make_rgb_emission() if emits else make_rgb_spectrum()

        @cached_property
        def majorants(self) -> FloatArray:
            """The upper bounds of σ_t (kz, ky, kx) in equal blocks of the volume's box."""
            rows = self.lookup.reduce_table_to_values()[:, 3] * self.lookup.extinction[0]
            if self.block_ranges is None:
                return rows.max(keepdims=True).reshape(1, 1, 1)
            return bound_piecewise_linear(
                rows, *map(self.lookup.find_table_rows, self.block_ranges)
            )

        @cached_property
        def block_ranges(self) -> tuple[FloatArray, FloatArray] | None:
            """The smallest and largest values in equal blocks of the box; None without a grid."""
            data = read_grid_values(self.values)
            return None if data is None else find_block_ranges(data)

    return TransferFunctionVolume


def find_box_transform(mi: MitsubaModule, values: MitsubaObject) -> MitsubaObject:
    """Return the transform from the unit cube to the axis-aligned bounding box of a volume."""
    box = values.bbox()
    return mi.ScalarTransform4f().translate(box.min).scale(box.extents())


def read_transfer_function(transfer: str, values: MitsubaObject) -> TransferFunction:
    """Read a `TransferFunction` from a preset, file or text, and scale it to a volume of `values`.

    Raises `BrdfkitError` if `transfer` is none of these, and for values without the gradient
    magnitudes that the function needs.
    """
    if transfer.lstrip().startswith("{"):
        function = files.parse_json(TransferFunction, transfer, "transfer_function: transfer")
    else:
        function = TransferFunction.load(resolve_file(transfer))
    channels = 1 if function.gradients is None else 2
    count = values.channel_count() or 1  # a constvolume reports 0
    if count != channels:
        raise BrdfkitError(
            f"transfer_function: the function {function.name} is one of {CHANNELS[channels]}, and "
            f"the volume's number of channels is {count}; it should be {channels}."
        )
    data = read_grid_values(values)
    return function if data is None else scale_transfer_to_values(function, data)


def example() -> dict[str, Any]:
    """Return a transfer function over a grid with one high voxel, to test the plugin."""
    import mitsuba as mi

    values = np.pad(np.full((1, 1, 1, 1), 2.0, np.float32), ((1, 1), (1, 1), (1, 1), (0, 0)))
    grid = {"type": "gridvolume", "grid": mi.VolumeGrid(values), "raw": True}
    function = TransferFunction([0, 2], [[0.2, 0.3, 0.4, 0], [0.8, 0.7, 0.6, 1]], extinction=3)
    return {"type": "transfer_function", "values": grid, "transfer": function.to_json()}
