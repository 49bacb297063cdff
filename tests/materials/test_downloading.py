"""Public collections: what the index says of them, and downloads from a server on this machine."""

import copy
import hashlib
import io
import json
import re
import threading
import zipfile
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer

import pytest
from click.testing import CliRunner
from small_files import curet, curet_table, merl

from brdfkit.cli import main
from brdfkit.core import catalogue
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.files import compute_sha256
from brdfkit.materials.collections import public
from brdfkit.materials.collections.downloading import download
from brdfkit.materials.loading import load

TABLE = merl((30, 20, 40))  # more than the 256 kB that are read at once
OTHER = merl((30, 20, 40), raw=range(72_000))


class Handler(BaseHTTPRequestHandler):
    """Sends the server's `files`, and parts of them; breaks off behind `server.breaks` bytes."""

    protocol_version = "HTTP/1.1"

    def do_GET(self):
        server, asked = self.server, self.headers.get("Range")
        server.asked.append((self.path, asked))
        data = server.files.get(self.path)
        if server.status or data is None:
            return self.send_error(server.status or 404)
        total, status = len(data), 200
        if asked and server.ranges:
            first, last = re.fullmatch(r"bytes=(\d+)-(\d*)", asked).groups()
            if int(first) >= total:
                return self.send_error(416)
            last, status = min(int(last or total), total - 1), 206
            data = data[int(first) : last + 1]
        self.send_response(status)
        self.send_header("Content-Length", str(len(data)))
        if status == 206:
            self.send_header("Content-Range", f"bytes {first}-{last}/{total}")
        self.end_headers()
        sent = data if server.breaks is None else data[: server.breaks]
        server.sent += len(sent)
        self.wfile.write(sent)
        self.close_connection = sent is not data
        return None

    def log_message(self, *_):
        pass


@pytest.fixture
def server():
    with ThreadingHTTPServer(("127.0.0.1", 0), Handler) as running:
        running.files, running.asked, running.sent = {"/grey.binary": TABLE}, [], 0
        running.ranges, running.breaks, running.status = True, None, None
        thread = threading.Thread(target=running.serve_forever, kwargs={"poll_interval": 0.01})
        thread.start()
        yield running
        running.shutdown()
        thread.join()


@pytest.fixture
def cache(tmp_path, monkeypatch):
    """An empty cache folder, not yet made."""
    monkeypatch.setattr(public, "find_cache_folder", lambda: tmp_path / "cache")
    return tmp_path / "cache"


@pytest.fixture
def lab(server, cache, monkeypatch):
    """A function that makes `lab` the only collection, with one file, which is on the server."""
    own, read = catalogue.read_index(), catalogue.read_index

    def put(file="grey.binary", data=TABLE, **entry):
        url = f"http://127.0.0.1:{server.server_port}/{{file}}"
        row = {"file": file, "bytes": len(data), "sha256": hashlib.sha256(data).hexdigest()}
        collection = {
            "title": "greys",
            "citation": "A. Grey, 1999",
            "licence": "CC0-1.0",
            "terms": "take it",
            "page": "https://lab.example/greys",
            "url": url,
            "files": [row],
        }
        entries = own | {"collections": {"lab": collection | entry}}

        def entries_of(kind=catalogue.MEASURED):
            return copy.deepcopy(entries) if kind == catalogue.MEASURED else read(kind)

        monkeypatch.setattr(catalogue, "read_index", entries_of)
        return cache / "lab" / file

    return put


def fails(name="lab/grey", call=download):
    """The sentence with which a call ends."""
    with pytest.raises(BrdfkitError) as told:
        call(name)
    sentence = str(told.value)
    assert sentence.endswith(".")
    assert "\n" not in sentence
    return sentence


def files(folder):
    return sorted(path.name for path in folder.rglob("*") if path.is_file())


# What works


@pytest.mark.quick
def test_download_and_load_by_name(server, lab):
    place, told = lab(), []
    assert download("lab/grey", lambda *progress: told.append(progress)) == place
    assert place.read_bytes() == TABLE
    assert files(place.parent) == ["grey.binary"]
    assert told == sorted(told)
    assert len(told) > 1
    assert told[-1] == (len(TABLE), len(TABLE))
    assert load("lab/grey").table.shape == (30, 20, 40)
    download("lab/grey")
    assert len(server.asked) == 1


@pytest.mark.quick
def test_nothing_is_downloaded_unasked(server, lab):
    lab()
    assert "run 'brdfkit data get lab/grey'" in fails(call=load)
    assert not server.asked


@pytest.mark.quick
def test_interrupted_then_resumed(server, lab):
    place = lab()
    server.breaks = len(TABLE) // 2
    assert "the connection to 127.0.0.1 failed" in fails()
    part = place.with_name("grey.binary.part")
    assert files(place.parent) == [part.name]
    assert "is not downloaded yet" in fails(call=load)
    assert not public.find_collection("lab").list_files_on_disk()
    have = part.stat().st_size
    assert 0 < have <= server.breaks
    server.breaks = None
    download("lab/grey")
    assert place.read_bytes() == TABLE
    assert files(place.parent) == ["grey.binary"]
    assert server.asked[1] == ("/grey.binary", f"bytes={have}-")
    assert server.sent == len(TABLE) // 2 + len(TABLE) - have


@pytest.mark.quick
def test_ctrl_c_keeps_what_is_there(server, lab):
    place = lab()

    def interrupt(done, total):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        download("lab/grey", interrupt)
    assert files(place.parent) == ["grey.binary.part"]
    download("lab/grey")
    assert place.read_bytes() == TABLE


@pytest.mark.quick
@pytest.mark.parametrize("case", ["no ranges", "no checksum"])
def test_starts_anew_where_it_cannot_resume(server, lab, case):
    """The server sends all, or nothing tells whether the halves belong together."""
    rows = [{"file": "grey.binary"}]
    place = lab(files=rows) if case == "no checksum" else lab()
    place.parent.mkdir(parents=True)
    place.with_name("grey.binary.part").write_bytes(b"something else")
    server.ranges = case != "no ranges"
    download("lab/grey")
    assert place.read_bytes() == TABLE


@pytest.mark.quick
def test_all_was_there_but_for_the_name(server, lab):
    place = lab()
    place.parent.mkdir(parents=True)
    place.with_name("grey.binary.part").write_bytes(TABLE)
    download("lab/grey")
    assert place.read_bytes() == TABLE
    assert server.sent == 0


def archive(*members, **options):
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED, **options) as file:
        for name, data in members:
            file.writestr(name, data)
    return stream.getvalue()


def test_one_file_of_an_archive(server, lab):
    noise = hashlib.shake_256(b"").digest(20_000_000)
    server.files["/all.zip"] = archive(("db/other.bin", noise), ("db/grey.binary", TABLE))
    place, told = lab(url=f"http://127.0.0.1:{server.server_port}/all.zip#db/{{file}}"), []
    download("lab/grey", lambda *progress: told.append(progress))
    assert place.read_bytes() == TABLE
    assert told[-1] == (len(TABLE), len(TABLE))
    assert files(place.parent) == ["grey.binary"]
    assert len(server.asked) <= 6  # servers count them
    assert server.sent < 15_000_000


# What does not


@pytest.mark.quick
def test_the_wrong_file_is_removed(server, lab):
    place = lab()
    server.files["/grey.binary"] = OTHER
    sentence = fails()
    assert "checksum differs), and was removed" in sentence
    assert "https://lab.example/greys" in sentence
    assert not files(place.parent)
    server.files["/grey.binary"] = TABLE
    assert download("lab/grey").read_bytes() == TABLE


@pytest.mark.quick
def test_halves_that_do_not_belong_together(server, lab):
    place = lab()
    place.parent.mkdir(parents=True)
    place.with_name("grey.binary.part").write_bytes(OTHER[:1000])
    assert "checksum differs" in fails()
    assert not files(place.parent)
    assert download("lab/grey").read_bytes() == TABLE


@pytest.mark.quick
@pytest.mark.parametrize("status", [404, 429, 503])
def test_an_error_of_the_server(server, lab, status):
    place = lab()
    server.status = status
    sentence = fails()
    assert f"127.0.0.1 answers {status}" in sentence
    assert (
        f"fetch grey.binary from https://lab.example/greys and put it into {place.parent}"
        in sentence
    )
    assert not files(place.parent)


@pytest.mark.quick
def test_offline(server, lab):
    lab(url="http://127.0.0.1:1/{file}")  # where nothing listens
    assert "the connection to 127.0.0.1 failed" in fails()


@pytest.mark.quick
@pytest.mark.parametrize("case", ["no ranges", "no such member", "no archive", "404"])
def test_archives_that_do_not_give_it(server, lab, case):
    place = lab(url=f"http://127.0.0.1:{server.server_port}/all.zip#db/{{file}}")
    if case != "404":
        members = (
            [("db/other.binary", OTHER)]
            if case == "no such member"
            else [("db/grey.binary", TABLE)]
        )
        server.files["/all.zip"] = b"no zip" * 100 if case == "no archive" else archive(*members)
    server.ranges = case != "no ranges"
    sentence = fails()
    assert "404" in sentence if case == "404" else "does not give this file" in sentence
    assert not files(place.parent)


@pytest.mark.quick
def test_a_cache_that_cannot_be_written(server, lab, cache):
    lab()
    cache.write_text("a file where the folder belongs")
    sentence = fails()
    assert str(cache) in sentence
    assert "cannot be written" in sentence


@pytest.mark.quick
def test_a_file_that_was_changed(server, lab):
    place = lab()
    download("lab/grey")
    place.write_bytes(OTHER)
    sentence = fails(call=load)
    assert str(place) in sentence
    assert "delete it and run 'brdfkit data get lab/grey'" in sentence
    download("lab/grey")  # or leave the deleting to it
    assert place.read_bytes() == TABLE


# By hand


@pytest.mark.quick
def test_by_hand_the_sentence_says_which_file_from_where_to_where(server, lab):
    place = lab(url="", note="unpacked from all.zip")
    for call in (load, download):
        assert fails(call=call) == (
            "lab/grey: is not downloaded yet; fetch grey.binary from https://lab.example/greys and "
            f"put it into {place.parent}, unpacked from all.zip."
        )
    place.parent.mkdir(parents=True)
    place.write_bytes(TABLE)
    assert load("lab/grey").name == "grey"
    assert download("lab/grey") == place
    place.write_bytes(OTHER)
    assert "checksum differs); delete it and fetch grey.binary" in fails(call=load)
    assert not server.asked


@pytest.mark.quick
def test_files_that_the_index_does_not_know(lab, cache):
    lab(files=[])
    assert "lab/mine: is not known; fetch its file from" in fails("lab/mine", load)
    (cache / "lab").mkdir(parents=True)
    (cache / "lab" / "mine.binary").write_bytes(TABLE)
    for name in (".DS_Store", "notes.txt", "SHA256SUMS", "._mine.binary", "half.binary.part"):
        (cache / "lab" / name).write_bytes(TABLE)
    assert load("lab/mine").name == "mine"
    assert list(public.find_collection("lab").list_files_on_disk()) == ["lab/mine"]


@pytest.mark.quick
def test_a_sample_of_a_file_with_many(lab, cache):
    place = lab(file="abrdf.dat", data=curet(), url="")
    place.parent.mkdir(parents=True)
    place.write_bytes(curet())
    (place.parent / "table.txt").write_bytes(curet_table())
    assert load("lab/abrdf#12").values[0, 0] == pytest.approx(12)


@pytest.mark.quick
def test_names_that_are_none(lab, tmp_path, monkeypatch):
    lab()
    assert "'brdfkit data list lab' names what is known" in fails("lab/nope", load)
    assert "nope/grey: there is no collection 'nope'; there are lab" in fails("nope/grey")
    assert "there is no such file" in fails("nope/grey", load)
    monkeypatch.chdir(tmp_path)
    (tmp_path / "lab").mkdir()
    (tmp_path / "lab" / "grey").write_bytes(TABLE)
    assert load("lab/grey").table.shape == (30, 20, 40)  # a file goes before a name


# The command line


def cli(*words):
    return CliRunner().invoke(main, [str(word) for word in words])


@pytest.mark.quick
def test_commands(server, lab):
    place = lab()
    assert "greys" in cli("data").stdout
    assert "to download" in cli("data", "list", "lab").stdout
    result = cli("data", "get", "lab/grey")
    assert (result.exit_code, result.stderr) == (0, "")
    assert str(place) in result.stdout
    assert "Terms: take it\nCite: A. Grey, 1999\n" in result.stdout
    assert "here" in cli("data", "list", "lab").stdout
    assert json.loads(cli("data", "get", "lab/grey", "--json").stdout)["files"] == {
        "lab/grey": str(place)
    }
    listed = json.loads(cli("data", "list", "lab", "--json").stdout)
    assert listed["files"]["lab/grey"]["path"] == str(place)
    assert json.loads(cli("data", "--json").stdout)["lab"] == listed
    assert cli("info", "lab/grey").exit_code == 0
    assert cli("data", "get", "lab/grey", "--quiet").stdout == ""


@pytest.mark.quick
@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["data", "get"], "NAME"),
        (["data", "get", "lab/nope"], "lab/nope"),
        (["data", "get", "nope"], "there are lab"),
        (["data", "list", "nope"], "there are lab"),
        (["data", "nope"], "nope"),
        (["info", "lab/grey"], "brdfkit data get lab/grey"),
        (["render", "lab/grey"], "brdfkit data get lab/grey"),
    ],
)
def test_wrong_words(lab, cache, words, said):
    lab()
    result = cli(*words)
    assert result.exit_code == 2
    assert result.stdout == ""
    assert result.stderr.startswith("brdfkit: ")
    assert result.stderr.count("\n") == 1
    assert said in result.stderr
    assert not cache.exists()


@pytest.fixture
def scan(lab, server, cache):
    """The collection `lab` has a folder with two files, which are on the server."""
    parts = {"scan/1.png": b"one", "scan/lights/1.txt": b"0 0 1"}
    server.files |= {f"/{file}": data for file, data in parts.items()}
    lab(
        files=[
            {"file": file, "bytes": len(data), "sha256": hashlib.sha256(data).hexdigest()}
            for file, data in parts.items()
        ]
    )
    return cache / "lab" / "scan"


@pytest.mark.quick
def test_a_folder_of_photographs(scan, server):
    assert "brdfkit data get lab/scan" in fails("lab/scan", public.find_folder)
    assert "brdfkit svbrdf lab/scan" in fails("lab/scan", load)
    assert re.search("lab/scan .*to download", cli("data", "list", "lab").stdout)
    told = []
    assert download("lab/scan", lambda *bytes_done: told.append(bytes_done)) == scan
    assert public.find_folder("lab/scan") == scan
    assert files(scan) == ["1.png", "1.txt"]
    assert (scan / "lights" / "1.txt").read_bytes() == b"0 0 1"
    assert told == [(3, 8), (8, 8)]
    asked = len(server.asked)
    result = cli("data", "get", "lab/scan")
    assert (result.exit_code, len(server.asked)) == (0, asked)
    assert str(scan) in result.stdout
    listed = cli("data", "list", "lab").stdout
    assert re.search("lab/scan .*here", listed)
    assert "1.png" not in listed
    assert "did you mean lab/scan" in fails("lab/scam", public.find_folder)


@pytest.mark.quick
def test_a_changed_file_in_a_folder_is_fetched_again(scan):
    download("lab/scan")
    (scan / "1.png").write_bytes(b"two")
    download("lab/scan")
    assert (scan / "1.png").read_bytes() == b"one"


# What the index says


@pytest.mark.quick
def test_the_index_is_complete():
    found = public.list_collections()
    assert public.list_collections() == found  # what was read before is as it was
    assert {name: len(c.files) for name, c in found.items()} == {
        "merl": 100, "rgl": 62, "cornell": 6, "curet": 1, "utia": 0, "captures": 244,
    }  # fmt: skip
    for collection in found.values():
        assert all([collection.title, collection.citation, collection.licence, collection.terms])
        assert collection.page.startswith("http")
        for name, listed in collection.files.items():
            assert name == listed.name
            assert not listed.url or re.fullmatch(r"https://[^{} ]+", listed.url)
            assert not listed.url or listed.url.endswith(listed.path.name)
            assert re.fullmatch(r"([0-9a-f]{64})?", listed.sha256)
    merl = found["merl"].files.values()
    assert {listed.bytes for listed in merl} == {34_992_012}
    assert len({listed.sha256 for listed in merl}) == 100
    folder = found["rgl"].files["rgl/cc_iris_purple_gem_rgb"].url.split("/")[-2]
    assert folder == "cc_iris_purple_gem"


@pytest.mark.quick
@pytest.mark.parametrize("folder", ["rgl", "cornell", "curet"])
def test_checksums_are_those_of_real_files(measured_data, folder):
    known = {listed.file: listed for listed in public.find_collection(folder).files.values()}
    there = [f for f in (measured_data / folder).iterdir() if known.get(f.name)]
    assert there
    for file in there:
        assert compute_sha256(file) == known[file.name].sha256
        assert file.stat().st_size == known[file.name].bytes
