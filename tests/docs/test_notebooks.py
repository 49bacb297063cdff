"""Every notebook runs from its first cell to its last, and `make notebook` opens them as such."""

import json
import os
import re
import shutil
import signal
import socket
import subprocess
import sys
import time
from pathlib import Path
from urllib.error import URLError
from urllib.request import urlopen

import drjit as dr
import jupytext
import matplotlib.pyplot as plt
import pytest
from chromium import execute_beside_chromium
from IPython.core.interactiveshell import InteractiveShell
from IPython.utils.capture import capture_output

TOP = Path(__file__).parents[2]
NOTEBOOKS = sorted(path for path in (TOP / "notebooks").glob("*.md") if path.stem != "README")
SMALLER = {  # smaller pictures and shorter searches, of which the notebooks' asserts hold, too
    r"spp=32, size=\d+": "spp=8, size=32",
    r"size=(256|128)\)": "size=32)",
    r"starts=4": "starts=1",
    r"samples=256": "samples=64",
    r"spp=(256|128), starts": "spp=64, starts",
    r"spp=256,\n": "spp=64,\n",
    r"spp=1024": "spp=512",
    r"size=\(64, 64\)": "size=(32, 32)",
    r"size=\(48, 48\)": "size=(24, 24)",
    r'"width": 32, "height": 32': '"width": 20, "height": 20',
}
WITH_A_WIDGET = "look_into_a_volume"
# Only these, because a kernel takes as long to start as a notebook to run
IN_A_KERNEL = "first_render", WITH_A_WIDGET
WIDGET_VIEW = "application/vnd.jupyter.widget-view+json"
WIDGET_STATE = "application/vnd.jupyter.widget-state+json"
# a notebook has as many threads as a test (conftest.py): more would wait for the other tests'
SHARE_THE_CORES = (
    f"import brdfkit.core.jit.threads as t; t.set_thread_count({dr.thread_count()}); del t"
)


def read_notebook(path):
    """The notebook, with smaller pictures."""
    text = path.read_text(encoding="utf-8")
    for large, small in SMALLER.items():
        text = re.sub(large, small, text)
    return jupytext.reads(text, fmt="md:myst")


@pytest.mark.parametrize(
    "path", [p for p in NOTEBOOKS if p.stem not in IN_A_KERNEL], ids=lambda path: path.stem
)
def test_a_notebook_runs(path, tmp_path, monkeypatch, llvm_variant, no_user_plugins):
    """Each cell runs without an error or a warning, and something is displayed."""
    monkeypatch.chdir(tmp_path)
    # A shell takes the place of the main module, which processes of later tests need as it is
    monkeypatch.setitem(sys.modules, "__main__", sys.modules["__main__"])
    shell = InteractiveShell.instance()
    monkeypatch.setitem(sys.modules, "__main__", shell.user_module)
    shell.reset(new_session=False)
    displayed = 0
    with plt.rc_context():
        for cell in read_notebook(path).cells:
            if cell.cell_type == "code":
                with capture_output() as output:
                    shell.run_cell(cell.source).raise_error()
                assert output.stderr == "", cell.source
                displayed += bool(output.outputs or output.stdout)
    plt.close("all")
    shell.reset(new_session=False)
    assert displayed
    assert not list(tmp_path.iterdir()), "it leaves files behind"


@pytest.mark.parametrize("name", IN_A_KERNEL)
def test_a_notebook_runs_in_a_kernel(name, tmp_path):
    """Without a warning; a widget that it shows is in it with its state, as viewers load it."""
    import nbclient  # only here: it takes seconds

    notebook = read_notebook(TOP / "notebooks" / f"{name}.md")
    client = nbclient.NotebookClient(
        notebook,
        timeout=300,
        resources={"metadata": {"path": tmp_path}},
        extra_arguments=[f"--IPKernelApp.exec_lines={SHARE_THE_CORES}"],
    )
    execute_beside_chromium(client)
    outputs = [output for cell in notebook.cells for output in cell.get("outputs", ())]
    assert outputs
    assert not [output for output in outputs if output.get("name") == "stderr"]
    assert not list(tmp_path.iterdir()), "it leaves files behind"
    shown = [
        output["data"][WIDGET_VIEW] for output in outputs if WIDGET_VIEW in output.get("data", ())
    ]
    assert len(shown) == (name == WITH_A_WIDGET)
    for view in shown:
        kept = notebook.metadata["widgets"][WIDGET_STATE]["state"][view["model_id"]]
        assert kept["model_module"] == "anywidget"
        assert "export default { render };" in kept["state"]["_esm"]


def test_the_index_names_every_notebook():
    index = (TOP / "notebooks" / "README.md").read_text(encoding="utf-8")
    assert [path.name for path in NOTEBOOKS if f"]({path.name})" not in index] == []


@pytest.mark.skipif(not shutil.which("make"), reason="there is no make")
def test_make_notebook(tmp_path):
    """JupyterLab starts, and opens Markdown as notebooks; nothing is written into a home."""
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        address = f"http://127.0.0.1:{free.getsockname()[1]}"
    settings = {
        "ServerApp": {"open_browser": False, "allow_root": True, "port": int(address[17:])},
        "IdentityProvider": {"token": ""},
    }
    (tmp_path / "jupyter_lab_config.json").write_text(json.dumps(settings))
    folders = dict.fromkeys(("HOME", "JUPYTER_CONFIG_DIR", "JUPYTER_RUNTIME_DIR"), str(tmp_path))
    labconfig = tmp_path / "labconfig" / "default_setting_overrides.json"
    server = subprocess.Popen(
        [
            "make",
            "-o",
            f"{sys.prefix}/.ready",
            f"VENV={sys.prefix}",
            f"LABCONFIG={labconfig}",
            "notebook",
        ],
        cwd=TOP,
        env=os.environ | folders,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        start_new_session=True,
    )
    try:
        assert _get(f"{address}/").geturl() == f"{address}/lab/tree/notebooks/first_render.md"
        shown = json.load(_get(f"{address}/api/contents/notebooks/first_render.md?content=0"))
        viewer = _get(f"{address}/lab/api/settings/@jupyterlab/docmanager-extension:plugin")
    finally:
        os.killpg(server.pid, signal.SIGTERM)
        server.wait(300)
    assert shown["type"] == "notebook"
    assert b"Jupytext Notebook" in viewer.read()


def _get(address, patience=300):
    """The answer of a server that may still be starting, for `patience` seconds."""
    end = time.monotonic() + patience
    while True:
        try:
            return urlopen(address, timeout=patience)
        except URLError:
            if time.monotonic() > end:
                raise
            time.sleep(0.2)
