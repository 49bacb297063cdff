"""Draws the conformance set in VTK, by `vtkGPUVolumeRayCastMapper` in 8 bits per channel.

VTK blends the numbers of colours without any conversion, so linear ones go in and come out. The
opacity follows from pictures before a black and before a white background.
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


def find_version():
    return vtk.vtkVersion.GetVTKVersion()


def draw_case(case, setting):
    """Return RGB and opacity (height, width, 4) of a case."""
    careful = setting == "careful"
    padding = 1 if careful else 0
    image = make_image_data(np.pad(case.voxels, padding, mode="edge"), case.spacing, padding)
    if case.renderer == "isosurface":
        actor = make_isosurface(image, case) if careful else make_volume(image, case, setting)
    else:
        actor = make_volume(image, case, setting)
    found = np.full((PIXELS, PIXELS, 4), np.nan)
    found[..., :3] = render_actor(actor, case, BEHIND)
    found[..., 3] = 1 - (render_actor(actor, case, 1.0) - render_actor(actor, case, 0.0)).mean(
        axis=-1
    )
    return found


def make_image_data(voxels, spacing, padding=0):
    """Return the VTK image of some voxels, whose points are the centres of voxels."""
    image = vtk.vtkImageData()
    image.SetDimensions(voxels.shape[::-1])
    image.SetSpacing(spacing)
    image.SetOrigin(spacing * (0.5 - padding) - 1)
    image.GetPointData().SetScalars(numpy_to_vtk(voxels.ravel(), deep=True))
    return image


def make_volume(image, case, setting):
    mapper = vtk.vtkGPUVolumeRayCastMapper()
    mapper.SetInputData(image)
    if setting == "careful":
        mapper.SetAutoAdjustSampleDistances(False)
        mapper.SetSampleDistance(SAMPLE_DISTANCE)
        clip_to_cube(mapper)
    looks = vtk.vtkVolumeProperty()
    looks.SetInterpolationTypeToLinear()
    if case.entry["labels"]:
        looks.SetInterpolationTypeToNearest()
    if case.renderer == "maximum_intensity":
        mapper.SetBlendModeToMaximumIntensity()
    if case.renderer == "isosurface":
        mapper.SetBlendModeToIsoSurface()
        looks.GetIsoSurfaceValues().SetValue(0, case.entry["level"])
        looks.ShadeOn()
        looks.SetAmbient(0)
        looks.SetDiffuse(1)
        looks.SetSpecular(0)
    set_transfer(looks, case, setting)
    actor = vtk.vtkVolume()
    actor.SetMapper(mapper)
    actor.SetProperty(looks)
    return actor


def clip_to_cube(mapper):
    """Clip a volume to the cube from -1 to 1."""
    for normal in np.vstack([np.eye(3), -np.eye(3)]):
        plane = vtk.vtkPlane()
        plane.SetOrigin(-normal)
        plane.SetNormal(normal)
        mapper.AddClippingPlane(plane)


def set_transfer(looks, case, setting):
    v, rgb, a, unit = compute_opacities(case, setting)
    colour, opacity = vtk.vtkColorTransferFunction(), vtk.vtkPiecewiseFunction()
    for x, c, o in zip(v, rgb, a, strict=True):
        colour.AddRGBPoint(x, *c)
        opacity.AddPoint(x, o)
    looks.SetColor(colour)
    looks.SetScalarOpacity(opacity)
    looks.SetScalarOpacityUnitDistance(unit)
    if "gradients" in case.transfer:
        ramp = vtk.vtkPiecewiseFunction()
        unit = case.spacing.mean() if setting == "careful" else 1  # VTK's default
        for gradient, factor in zip(case.transfer["gradients"], (0, 1), strict=True):
            ramp.AddPoint(gradient * unit, factor)
        looks.SetGradientOpacity(ramp)


def compute_opacities(case, setting):
    """Return values (n,), RGB (n, 3), opacities (n,) and the unit distance of opacities."""
    if case.renderer == "isosurface":
        return case.values, np.tile(case.entry["albedo"], (len(case.values), 1)), np.ones(2), 1.0
    if setting == "typed in" or case.renderer == "maximum_intensity":
        unit = case.transfer.get("opacity_unit_distance", 1.0)
        v = case.values.copy()
        v[:-1][np.diff(v) == 0] -= 1e-6
        return v, case.rgba[:, :3], case.rgba[:, 3], unit
    v, rgb, sigma = case.sample_transfer()
    unit = 1 / sigma.max()
    return v, rgb, -np.expm1(-sigma * unit), unit


def make_isosurface(image, case):
    """Return the actor of an isosurface as a mesh, with normals along the gradients."""
    contour = vtk.vtkFlyingEdges3D()
    contour.SetInputData(image)
    contour.SetValue(0, case.entry["level"])
    contour.ComputeNormalsOn()
    mapper = vtk.vtkPolyDataMapper()
    mapper.SetInputConnection(contour.GetOutputPort())
    mapper.ScalarVisibilityOff()
    actor = vtk.vtkActor()
    actor.SetMapper(mapper)
    looks = actor.GetProperty()
    looks.SetColor(*case.entry["albedo"])
    looks.SetAmbient(0)
    looks.SetDiffuse(1)
    looks.SetSpecular(0)
    looks.SetInterpolationToPhong()
    return actor


def render_actor(actor, case, background):
    """Return the picture (height, width, 3) of an actor before a grey `background`."""
    window = make_window(actor, case, background, PIXELS)
    found = read_picture(window, PIXELS)
    window.Finalize()
    return found


def make_window(actor, case, background, pixels):
    """Return a square window off the screen that shows an actor before a grey `background`."""
    renderer = vtk.vtkRenderer()
    renderer.AddViewProp(actor)
    renderer.SetBackground([background] * 3)
    window = vtk.vtkRenderWindow()
    window.SetOffScreenRendering(True)
    window.SetMultiSamples(0)
    window.SetSize(pixels, pixels)
    window.AddRenderer(renderer)
    aim_camera(renderer.GetActiveCamera(), case)
    return window


def read_picture(window, pixels):
    """Render a window, and return its picture (height, width, 3)."""
    window.Render()
    found = vtk.vtkUnsignedCharArray()
    window.GetPixelData(0, 0, pixels - 1, pixels - 1, 0, found, 0)
    return vtk_to_numpy(found).reshape(pixels, pixels, 3)[::-1] / 255


def aim_camera(camera, case):
    towards, _, up = case.view_axes
    camera.ParallelProjectionOn()
    camera.SetParallelScale(case.entry["half"])
    camera.SetPosition(-DISTANCE * towards)
    camera.SetFocalPoint(0, 0, 0)
    camera.SetViewUp(up)
    camera.SetClippingRange(0.1, 2 * DISTANCE)
