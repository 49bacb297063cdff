"""Small files of volumes, written by other libraries, for the tests of their formats."""

import numpy as np

SHAPE = (4, 5, 6)  # nz, ny, nx
SPACING = (0.5, 0.75, 2.0)
ORIGIN = (10.0, -20.0, 30.0)


def rotation():
    """An oblique frame (3, 3), orthonormal and right-handed; no axis of it is nearest two."""
    a, b = np.radians(25), np.radians(-15)
    about_z = [[np.cos(a), -np.sin(a), 0], [np.sin(a), np.cos(a), 0], [0, 0, 1]]
    about_x = [[1, 0, 0], [0, np.cos(b), -np.sin(b)], [0, np.sin(b), np.cos(b)]]
    return np.array(about_z) @ about_x


TO_WORLD = np.eye(4)
TO_WORLD[:3, :3] = rotation() * SPACING
TO_WORLD[:3, 3] = ORIGIN


def values(dtype=np.int16, shape=SHAPE):
    """Numbers that are all different, also below 0 where the type has such."""
    numbers = np.arange(np.prod(shape)).reshape(shape)
    return (numbers - (50 if np.dtype(dtype).kind != "u" else 0)).astype(dtype)


def by_itk(path, compressed=False, dtype=np.int16):
    """A file with an oblique frame, as SimpleITK writes the format of the suffix."""
    import SimpleITK as sitk

    image = sitk.GetImageFromArray(values(dtype))
    image.SetSpacing(SPACING)
    image.SetOrigin(ORIGIN)
    image.SetDirection(rotation().ravel().tolist())
    sitk.WriteImage(image, str(path), useCompression=compressed)


def read_by_itk(path):
    """The values and the transform of a file, or of the files of a series, read by SimpleITK.

    Its world is LPS; the transform is turned to RAS.
    """
    import SimpleITK as sitk

    if path.is_dir():
        path = sitk.ImageSeriesReader.GetGDCMSeriesFileNames(str(path))
    image = sitk.ReadImage(path if isinstance(path, tuple) else str(path))
    corners = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
    points = [np.array(image.TransformIndexToPhysicalPoint(corner)) for corner in corners]
    to_world = np.eye(4)
    to_world[:3, :3] = np.column_stack([point - points[0] for point in points[1:]])
    to_world[:3, 3] = points[0]
    return sitk.GetArrayFromImage(image), np.diag([-1, -1, 1, 1]) @ to_world


def nifti(path, dtype=np.int16, sform=1, qform=0, slope=1, intercept=0, order="<", **header):
    """A file of nibabel's, x fastest; the qform, if it is another, is not oblique."""
    import nibabel

    image = nibabel.Nifti1Image(values(dtype).T, None, nibabel.Nifti1Header(endianness=order))
    image.set_data_dtype(dtype)
    image.set_qform(TO_WORLD if not sform else np.diag([*SPACING, 1]), qform)
    image.set_sform(TO_WORLD if sform else None, sform)
    for name, value in header.items():
        image.header[name] = value
    image.header.set_slope_inter(slope, intercept)
    nibabel.save(image, path)


def dicom(folder, slope=1.0, intercept=0.0, gap=None, twice=False, series=1):
    """A series whose files are named against their order; `gap`: a slice that is missing."""
    import pydicom
    from pydicom.dataset import FileDataset, FileMetaDataset
    from pydicom.uid import CTImageStorage, ExplicitVRLittleEndian

    frame = rotation()
    layers = values()
    files = [(k, f"s{series}{9 - k}.dcm") for k in range(len(layers)) if k != gap]
    for k, name in [*files, *[(0, "twice.dcm")] * twice]:
        meta = FileMetaDataset()
        meta.MediaStorageSOPClassUID = CTImageStorage
        meta.TransferSyntaxUID = ExplicitVRLittleEndian
        meta.MediaStorageSOPInstanceUID = f"1.2.3.{series}.{k + 1}.{len(name)}"
        data = FileDataset(None, {}, file_meta=meta, preamble=b"\0" * 128)
        data.SOPClassUID, data.SOPInstanceUID = CTImageStorage, meta.MediaStorageSOPInstanceUID
        data.SeriesInstanceUID, data.StudyInstanceUID = f"1.2.3.{series}", "1.2.3"
        data.SeriesNumber, data.InstanceNumber, data.Modality = series, 1, "CT"
        data.Rows, data.Columns = SHAPE[1:]
        data.PixelSpacing = [SPACING[1], SPACING[0]]  # between rows, between columns
        data.ImageOrientationPatient = [round(c, 12) for c in frame.T[:2].ravel()]
        place = np.array(ORIGIN) + k * SPACING[2] * frame[:, 2]
        data.ImagePositionPatient = [round(c, 10) for c in place]
        data.SamplesPerPixel, data.PhotometricInterpretation = 1, "MONOCHROME2"
        data.BitsAllocated = data.BitsStored = 16
        data.HighBit, data.PixelRepresentation = 15, 1
        data.RescaleSlope, data.RescaleIntercept = slope, intercept
        data.PixelData = layers[k].tobytes()
        pydicom.dcmwrite(folder / name, data, enforce_file_format=True)


def vti(path, mode="appended", encoded=True, packed=True, cells=False, wide=False, dtype=np.int16):
    """A file that VTK writes, with an oblique frame."""
    from vtkmodules.util.numpy_support import numpy_to_vtk
    from vtkmodules.vtkCommonDataModel import vtkImageData
    from vtkmodules.vtkIOXML import vtkXMLImageDataWriter

    image = vtkImageData()
    nz, ny, nx = SHAPE
    image.SetDimensions(nx + cells, ny + cells, nz + cells)
    image.SetSpacing(SPACING)
    image.SetOrigin(ORIGIN)
    image.SetDirectionMatrix(rotation().ravel().tolist())
    array = numpy_to_vtk(values(dtype).ravel(), deep=True)
    array.SetName("density")
    (image.GetCellData() if cells else image.GetPointData()).SetScalars(array)
    writer = vtkXMLImageDataWriter()
    writer.SetFileName(str(path))
    writer.SetInputData(image)
    writer.SetDataMode({"ascii": 0, "binary": 1, "appended": 2}[mode])
    writer.SetEncodeAppendedData(encoded)
    writer.SetBlockSize(64)  # bytes: many blocks, and a smaller one at the end
    if not packed:
        writer.SetCompressorTypeToNone()
    writer.SetHeaderType(64 if wide else 32)
    writer.Write()
