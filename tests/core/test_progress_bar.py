"""The bar of `progress` in the kernel of a notebook; in a terminal: tests/cli/test_cli.py."""

import nbclient
import nbformat
import pytest
from chromium import execute_beside_chromium

import brdfkit as bk


def test_the_bar_of_a_notebook_moves_and_goes():
    source = """
from time import sleep
import brdfkit as bk
from brdfkit.core import progress_bar
progress_bar.DELAY = progress_bar.INTERVAL = 0
with bk.progress("a < b") as bar:
    for done in range(3):
        bar(done, 3)
"""
    notebook = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(source)])
    drawn = []

    class Client(nbclient.NotebookClient):
        def process_message(self, message, *rest):
            if "display" in message["msg_type"]:
                drawn.append(message["content"]["data"])
            return super().process_message(message, *rest)

    execute_beside_chromium(Client(notebook, timeout=300))
    shown = [data["text/html"] for data in drawn[:-1]]
    assert [f'value="{done}" max="3"' in html for done, html in enumerate(shown)] == [True] * 3
    assert all("a &lt; b" in html for html in shown)
    assert [output["data"] for output in notebook.cells[0].outputs] == [{"text/plain": ""}]


def test_what_is_no_text_is_told():
    with pytest.raises(bk.BrdfkitError, match="with progress"), bk.progress(3):
        pass
