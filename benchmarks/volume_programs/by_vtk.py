"""VTK: `vtkGPUVolumeRayCastMapper`, drawn without a screen, in 8 bits per channel.

Numbers of colours go in as they are and are read back as they are: VTK blends whatever numbers it
is given, here linear ones. The opacity of the whole is from pictures before black and before white.
"""

import numpy as np
import vtk
from vtk.util.numpy_support import numpy_to_vtk, vtk_to_numpy

from .case import BEHIND, DISTANCE, PIXELS

NAME = "VTK"
SETTINGS = {
    "typed in": "A typed in as the opacity, linear interpolation, all else at its defaults",
    "right unit": "opacity 1 - exp(-σ_t d) for the unit distance d, else likewise",
    "careful": "so, samples every 1/250 of the cube's edge, voxels repeated beyond the faces "
    "and clipped there, gradients per mean edge of a voxel, isosurfaces as meshes",
}
SAMPLE_DISTANCE = 2 / 250


def version():
    return vtk.vtkVersion.GetVTKVersion()


def picture(case, setting):
    """RGB and opacity (height, width, 4)."""
    careful = setting == "careful"
    padding = 1 if careful else 0
    image = image_data(np.pad(case.voxels, padding, mode="edge"), case.spacing, padding)
    if case.renderer == "isosurface":
        actor = surface(image, case) if careful else volume(image, case, setting)
    else:
        actor = volume(image, case, setting)
    found = np.full((PIXELS, PIXELS, 4), np.nan)
    found[..., :3] = shown(actor, case, BEHIND)
    found[..., 3] = 1 - (shown(actor, case, 1.0) - shown(actor, case, 0.0)).mean(axis=-1)
    return found


def image_data(voxels, spacing, padding=0):
    """VTK's points are the centres of voxels."""
    image = vtk.vtkImageData()
    image.SetDimensions(voxels.shape[::-1])
    image.SetSpacing(spacing)
    image.SetOrigin(spacing * (0.5 - padding) - 1)
    image.GetPointData().SetScalars(numpy_to_vtk(voxels.ravel(), deep=True))
    return image


def volume(image, case, setting):
    mapper = vtk.vtkGPUVolumeRayCastMapper()
    mapper.SetInputData(image)
    if setting == "careful":
        mapper.SetAutoAdjustSampleDistances(False)
        mapper.SetSampleDistance(SAMPLE_DISTANCE)
        clip(mapper)
    looks = vtk.vtkVolumeProperty()
    looks.SetInterpolationTypeToLinear()
    if case.told["labels"]:
        looks.SetInterpolationTypeToNearest()
    if case.renderer == "maximum_intensity":
        mapper.SetBlendModeToMaximumIntensity()
    if case.renderer == "isosurface":
        mapper.SetBlendModeToIsoSurface()
        looks.GetIsoSurfaceValues().SetValue(0, case.told["level"])
        looks.ShadeOn()
        looks.SetAmbient(0)
        looks.SetDiffuse(1)
        looks.SetSpecular(0)
    set_transfer(looks, case, setting)
    actor = vtk.vtkVolume()
    actor.SetMapper(mapper)
    actor.SetProperty(looks)
    return actor


def clip(mapper):
    """To the cube."""
    for normal in np.vstack([np.eye(3), -np.eye(3)]):
        plane = vtk.vtkPlane()
        plane.SetOrigin(-normal)
        plane.SetNormal(normal)
        mapper.AddClippingPlane(plane)


def set_transfer(looks, case, setting):
    v, rgb, a, unit = opacities(case, setting)
    colour, opacity = vtk.vtkColorTransferFunction(), vtk.vtkPiecewiseFunction()
    for x, c, o in zip(v, rgb, a, strict=True):
        colour.AddRGBPoint(x, *c)
        opacity.AddPoint(x, o)
    looks.SetColor(colour)
    looks.SetScalarOpacity(opacity)
    looks.SetScalarOpacityUnitDistance(unit)
    if "gradients" in case.transfer:
        ramp = vtk.vtkPiecewiseFunction()
        unit = case.spacing.mean() if setting == "careful" else 1  # VTK's own
        for gradient, factor in zip(case.transfer["gradients"], (0, 1), strict=True):
            ramp.AddPoint(gradient * unit, factor)
        looks.SetGradientOpacity(ramp)


def opacities(case, setting):
    """Values (n,), RGB (n, 3), opacities (n,) and the unit distance."""
    if case.renderer == "isosurface":
        return case.values, np.tile(case.told["albedo"], (len(case.values), 1)), np.ones(2), 1.0
    if setting == "typed in" or case.renderer == "maximum_intensity":
        unit = case.transfer.get("opacity_unit_distance", 1.0)
        v = case.values.copy()
        v[:-1][np.diff(v) == 0] -= 1e-6
        return v, case.rgba[:, :3], case.rgba[:, 3], unit
    v, rgb, sigma = case.sampled()
    unit = 1 / sigma.max()
    return v, rgb, -np.expm1(-sigma * unit), unit


def surface(image, case):
    """The isosurface as a mesh, with normals of the gradients."""
    contour = vtk.vtkFlyingEdges3D()
    contour.SetInputData(image)
    contour.SetValue(0, case.told["level"])
    contour.ComputeNormalsOn()
    mapper = vtk.vtkPolyDataMapper()
    mapper.SetInputConnection(contour.GetOutputPort())
    mapper.ScalarVisibilityOff()
    actor = vtk.vtkActor()
    actor.SetMapper(mapper)
    looks = actor.GetProperty()
    looks.SetColor(*case.told["albedo"])
    looks.SetAmbient(0)
    looks.SetDiffuse(1)
    looks.SetSpecular(0)
    looks.SetInterpolationToPhong()
    return actor


def shown(actor, case, background):
    """The picture (height, width, 3) before a background."""
    renderer = vtk.vtkRenderer()
    renderer.AddViewProp(actor)
    renderer.SetBackground([background] * 3)
    window = vtk.vtkRenderWindow()
    window.SetOffScreenRendering(True)
    window.SetMultiSamples(0)
    window.SetSize(PIXELS, PIXELS)
    window.AddRenderer(renderer)
    aim(renderer.GetActiveCamera(), case)
    window.Render()
    pixels = vtk.vtkUnsignedCharArray()
    window.GetPixelData(0, 0, PIXELS - 1, PIXELS - 1, 0, pixels, 0)
    found = vtk_to_numpy(pixels).reshape(PIXELS, PIXELS, 3)[::-1] / 255
    window.Finalize()
    return found


def aim(camera, case):
    towards, _, up = case.eye
    camera.ParallelProjectionOn()
    camera.SetParallelScale(case.told["half"])
    camera.SetPosition(-DISTANCE * towards)
    camera.SetFocalPoint(0, 0, 0)
    camera.SetViewUp(up)
    camera.SetClippingRange(0.1, 2 * DISTANCE)
