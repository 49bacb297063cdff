"""Transfer function: colours and extinction of a volume's values, for any medium or integrator.

    values v, and where the function has them, gradient magnitudes g → RGB, A
    output = extinction: σ_t = extinction · A(v, g)        output = colour: RGB(v, g)

`transfer` is the name of a preset, such as "ct_bone", a file that `TransferFunction.save` wrote, or
its text, by `to_json()`. A preset over shares of the range, as for MRI, is scaled to the least and
the largest value. `values` is a gridvolume, of any values, with `"raw": True`; that of a function
of gradient magnitudes has these as its second channel (`Volume.gradient_magnitude`). Labels have
`"filter_type": "nearest"`. Values are interpolated first, and looked up then.

`Volume.scene_dict(transfer)` makes all of this. So Mitsuba's own integrators render a scan:

    {"type": "heterogeneous", "albedo": {..., "output": "colour"}, "sigma_t": {...}}

both of this type, with the same `values`, within a cube of the same `to_world`. That is by default
the box of the values; an oblique grid needs its own, `Volume.cube_to_world`, in both. Integrators
of brdfkit take one such volume and look σ_t and RGB up at once. Derivatives go to the function's
table, to its extinction and to the values.

[Lesar 2018, chapter 6]; [Kniss et al. 2002]. RGB is linear sRGB; in spectral variants it becomes
the sum of three basis spectra [Mallett & Yuksel 2019], times D65 where it is an emission.
"""

from functools import cached_property

import drjit as dr
import numpy as np

from brdfkit.core.errors import BrdfkitError
from brdfkit.mitsuba_bridge.channels import emission_of_rgb, spectrum_of_rgb
from brdfkit.mitsuba_bridge.properties.conversions import resolve_file
from brdfkit.mitsuba_bridge.properties.declarations import declared, text, volume, word
from brdfkit.mitsuba_bridge.registration.registering import refuse_scalar
from brdfkit.volumes.light.majorants import data_of
from brdfkit.volumes.rays.voxel_steps import is_trilinear, typical
from brdfkit.volumes.transfer import files
from brdfkit.volumes.transfer.block_bounds import block_ranges, largest_between
from brdfkit.volumes.transfer.lookup import TransferLookup
from brdfkit.volumes.transfer.preintegration import is_thin
from brdfkit.volumes.transfer.transfer_function import TransferFunction
from brdfkit.volumes.transfer.windows import fitted

CHANNELS = {1: "values alone", 2: "values and gradient magnitudes"}
PARAMETERS = {
    "values": volume(0.0, "what the function is a function of", least=-np.inf),
    "transfer": text("ct_bone", "the function: a preset, a file, or its text"),
    "output": word(("extinction", "colour"), "what Mitsuba's media and textures get"),
}


def define(mi):
    """The class of `mi.Volume` for the current variant."""

    class TransferFunctionVolume(declared(mi.Volume, PARAMETERS)):
        def __init__(self, props):
            refuse_scalar("transfer_function")
            values = props.get("values", 0)
            if "to_world" not in props and isinstance(values, mi.Volume):
                props["to_world"] = box_of(mi, values)
            super().__init__(props)
            to_world = np.array(props.get("to_world", mi.ScalarTransform4f()).matrix)
            self.to_local = mi.Transform4f(np.linalg.inv(to_world))
            dr.make_opaque(self.to_local)
            self.function = function_of(self.transfer, self.values)
            self.lookup = TransferLookup(self.function)

        def traverse(self, callback):
            super().traverse(callback)
            callback.put("table", self.lookup.table, mi.ParamFlags.Differentiable)
            callback.put("extinction", self.lookup.extinction, mi.ParamFlags.Differentiable)

        def parameters_changed(self, keys=()):
            self.lookup.changed()
            self.__dict__.pop("majorants", None)

        def optics(self, it, active=True):
            """σ_t, and RGB in linear sRGB, from one look-up."""
            rgb, a = self.rgba(it, active)
            return self.lookup.extinction * a, rgb

        def is_missed_by(self, steps):
            """Whether the function has peaks or jumps that so many steps of a ray would jump over.

            Then `integrals` and `mean_optics` see them. Never of labels or gradient magnitudes.
            """
            data = data_of(self.values)
            if data is None or self.function.gradients is not None:
                return False
            low, high = self.function.range
            change = typical(data) * max(1, max(data.shape) / steps)  # of the value, in a step
            reach = change / (high - low) * self.lookup.integrals.steps
            thin = is_thin(np.array(self.lookup.table), reach)
            return thin and is_trilinear(self.values, data, self.to_local)

        def integrals(self, it, active=True):
            """At an end of a part of a ray, for `mean_optics`; of a function of values alone."""
            return self.lookup.integrals_at(self.values.eval_1(it, active))

        def mean_optics(self, front, back):
            """The means of σ_t and of σ_t RGB between two ends."""
            rgb, a = self.lookup.mean_between(front, back)
            return self.lookup.extinction * a, self.lookup.extinction * rgb

        def rgba(self, it, active=True):
            """RGB in linear sRGB, and A."""
            return self.lookup(self.places(it, active), active)

        def places(self, it, active=True):
            """[value], or [value, gradient magnitude]."""
            if self.function.gradients is None:
                return [self.values.eval_1(it, active)]
            return self.values.eval_n(it, active)

        def eval_1(self, it, active=True):
            sigma, rgb = self.optics(it, active)
            return sigma if self.output == "extinction" else mi.luminance(rgb)

        def eval(self, it, active=True):
            sigma, rgb = self.optics(it, active)
            if self.output == "extinction":
                return mi.UnpolarizedSpectrum(sigma)
            return self.spectrum(rgb, it)

        def max(self):
            rows = self.lookup.table_over_values()
            if self.output == "colour":
                return float(rows[:, :3].max())
            return float(self.majorants.max())

        def resolution(self):
            return self.values.resolution()

        @cached_property
        def spectrum(self):
            """A function (rgb, it) → spectrum, of what RGB means."""
            emits = self.function.colour == "emission"
            return emission_of_rgb() if emits else spectrum_of_rgb()

        @cached_property
        def majorants(self):
            """(kz, ky, kx) in NumPy: a bound of σ_t in each of as many equal blocks of the box."""
            rows = self.lookup.table_over_values()[:, 3] * self.lookup.extinction[0]
            data = data_of(self.values)
            if data is None:
                return rows.max(keepdims=True).reshape(1, 1, 1)
            return largest_between(rows, *map(self.lookup.steps_of, block_ranges(data)))

    return TransferFunctionVolume


def box_of(mi, values):
    """The transform from the unit cube to the box of a volume along the world's axes."""
    box = values.bbox()
    return mi.ScalarTransform4f().translate(box.min).scale(box.extents())


def function_of(transfer, values):
    """The `TransferFunction` of a preset, a file or a text, for a volume of `values`.

    Raises `BrdfkitError` where there is none, and for values without their gradient magnitudes.
    """
    if transfer.lstrip().startswith("{"):
        function = files.from_json(TransferFunction, transfer, "transfer_function: transfer")
    else:
        function = TransferFunction.load(resolve_file(transfer))
    channels = 1 if function.gradients is None else 2
    given = values.channel_count() or 1  # a constvolume says 0
    if given != channels:
        raise BrdfkitError(
            f"transfer_function: the function {function.name} is one of {CHANNELS[channels]}, and "
            f"the volume's number of channels is {given}; it should be {channels}."
        )
    data = data_of(values)
    return function if data is None else fitted(function, data)


def example():
    """A hill of values in the middle of the cube, for the checks."""
    import mitsuba as mi

    values = np.pad(np.full((1, 1, 1, 1), 2.0, np.float32), ((1, 1), (1, 1), (1, 1), (0, 0)))
    grid = {"type": "gridvolume", "grid": mi.VolumeGrid(values), "raw": True}
    function = TransferFunction([0, 2], [[0.2, 0.3, 0.4, 0], [0.8, 0.7, 0.6, 1]], extinction=3)
    return {"type": "transfer_function", "values": grid, "transfer": function.to_json()}
