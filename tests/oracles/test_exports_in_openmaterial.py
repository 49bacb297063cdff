"""Exported files of OpenMATERIAL 3D are valid by its schemas.

The environment variable BRDFKIT_OPENMATERIAL names a folder with the official schemas,
material_schema.json and material_brdf_schema.json of version 1.0.0; without it, the fields that
they demand are restated here.
"""

import json
import os
from pathlib import Path

import openmaterial
import pytest
from six_fits import make_fit

import brdfkit as bk
from brdfkit.exporting.targets import openmaterial as target

pytestmark = pytest.mark.oracles

TEXT, TEXTS = {"type": "string"}, {"type": "array", "items": {"type": "string"}, "minItems": 1}
VERSION = {"type": "string", "pattern": r"^\d+\.\d+\.\d+$"}
METADATA = {
    "name": TEXT,
    "uuid": {"type": "string", "pattern": "^[0-9a-f]{8}(-[0-9a-f]{4}){3}-[0-9a-f]{12}$"},
    "materialVersion": VERSION,
    "openMaterial3dVersion": VERSION,
    "copyrights": TEXTS,
    "license": TEXT,
    "authors": TEXTS,
}
# Wavelength [m], angles of incidence and exit, azimuth of exit [rad], and value [1/sr]
WAVELENGTH = {"type": "number", "minimum": 1e-9, "maximum": 17.16e-3}
LIMITS = 1.570796, 1.570796, 6.283185, float("inf")
ROW = [WAVELENGTH, *({"type": "number", "minimum": 0, "maximum": limit} for limit in LIMITS)]
TABLE = {"type": "array", "items": {"items": ROW, "minItems": 5, "maxItems": 5}}
CONTENTS = {
    "material": {"materialProperties": {"brdfUris": TEXTS}},
    "material_brdf": {
        "brdf": {"wavelengths": {"type": "array", "items": WAVELENGTH}, "lookupTable": TABLE}
    },
}


def make_object(properties):
    return {"type": "object", "properties": properties, "required": list(properties)}


def find_schema(name):
    if folder := os.environ.get("BRDFKIT_OPENMATERIAL"):
        return json.loads(Path(folder, f"{name}_schema.json").read_text(encoding="utf-8"))
    sources = {"sources": TEXT} if name == "material_brdf" else {}
    content = {key: make_object(fields) for key, fields in CONTENTS[name].items()}
    return make_object({"metadata": make_object(METADATA | sources), **content})


@pytest.mark.parametrize("name", ["metal", "brushed"])
def test_files_are_valid(name, tmp_path, monkeypatch):
    jsonschema = pytest.importorskip("jsonschema")
    monkeypatch.setattr(target, "AZIMUTHS", 2)  # all rows would take 20 s
    path = tmp_path / "größe 1.xomp"
    done = bk.export(make_fit(name), "openmaterial", path, accept_loss=True)
    assert done.paths == (path, openmaterial.find_table(path))
    identities = set()
    for file, schema in zip(done.paths, CONTENTS, strict=True):
        content = json.loads(file.read_text(encoding="utf-8"))
        errors = list(jsonschema.Draft7Validator(find_schema(schema)).iter_errors(content))
        assert not [error.message for error in errors[:3]]
        address = f"OpenMATERIAL-3D/refs/tags/v1.0.0/schemas/{schema}_schema.json"
        assert address in file.read_text(encoding="utf-8").splitlines()[1]
        identities.add(content["metadata"]["uuid"])
    assert len(identities) == 2
