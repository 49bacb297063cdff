"""What a folder of files holds: a series of DICOM, or pictures of a stack."""

from pathlib import Path

TIFF = ".tif", ".tiff"


def files(folder):
    """The files of a folder, without hidden ones, by name."""
    return sorted(p for p in Path(folder).iterdir() if p.is_file() and p.name[0] != ".")


def pictures(folder):
    """The TIFF files of a folder."""
    return [p for p in files(folder) if p.suffix.lower() in TIFF]


def kind(file):
    """The name of the format of a folder, "tiff" or "dicom"."""
    if not files(file.path):
        raise file.error("the folder is empty; name one with a series of DICOM or a stack of TIFF")
    return "tiff" if pictures(file.path) else "dicom"


def head(path, size):
    """The first bytes of a file; none of one that cannot be read."""
    try:
        with path.open("rb") as stream:
            return stream.read(size)
    except OSError:
        return b""
