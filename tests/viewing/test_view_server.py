"""The server of a view: who is let in, what it sends, and that nothing of a request is a path."""

import json
import threading
from functools import partial
from urllib.error import HTTPError
from urllib.request import Request, urlopen

import pytest

import brdfkit as bk
from brdfkit.core.errors import BrdfkitError
from brdfkit.viewing import server
from brdfkit.viewing.render_thread import RenderThread
from brdfkit.viewing.session import Session
from brdfkit.viewing.volumes.application import VolumeApplication


def ask(address, method="GET", **headers):
    """The status and the headers of an answer, which may be an error."""
    try:
        answer = urlopen(Request(address, headers=headers, method=method))
    except HTTPError as error:
        answer = error
    with answer:
        return answer.status, answer.headers


def status(address, **headers):
    return ask(address, **headers)[0]


def test_the_page_and_its_files_have_a_strict_policy(address):
    for name in ("", "page.js", "viewer.js", "viewer.css"):
        with urlopen(address + name) as answer:
            policy = answer.headers["Content-Security-Policy"]
            assert answer.read()
        assert policy.startswith("default-src 'none'")
        assert "unsafe" not in policy


@pytest.mark.parametrize(
    ("path", "method", "expected"),
    [
        ("/the-token/x/y", "GET", 404),
        ("/the-token/x", "GET", 404),
        ("/the-token/", "POST", 405),
        ("/the-token", "GET", 404),
        ("/another", "GET", 404),
        ("/another/", "GET", 403),
    ],
)
def test_every_refusal_has_the_policy(address, path, method, expected):
    answered, headers = ask(address.replace("/the-token/", path), method)
    assert answered == expected
    assert headers["Content-Security-Policy"] == server.POLICY


def test_other_names_sites_and_tokens_are_refused(address):
    port = address.split(":")[2].split("/")[0]
    assert status(address.replace("the-token", "another")) == 403
    assert status(address.replace("/the-token/", "/")) == 404
    for name in ("session.py", "..%2fserver.py", "%2e%2e/server.py", "/etc/passwd", "dom.js"):
        assert status(address + name) in (403, 404)
    assert status(address, Host=f"evil.example:{port}") == 403
    assert status(address, Origin="http://evil.example") == 403
    assert status(address, Host=f"localhost:{port}") == 200


def connect(address, **settings):
    from websockets.sync.client import connect

    origin = "http://" + address.split("/")[2]
    place = address.replace("http", "ws") + "session"
    return connect(place, **{"origin": origin, "max_size": 2**24} | settings)


@pytest.mark.parametrize("origin", [None, "http://evil.example", "http://127.0.0.1:1"])
def test_a_session_is_for_the_page_alone(address, origin):
    from websockets.exceptions import InvalidStatus

    with pytest.raises(InvalidStatus), connect(address, origin=origin):
        pass


def receive(socket):
    """The next message, and its bytes."""
    message = json.loads(socket.recv(timeout=60))
    return message, [socket.recv(timeout=60) for _ in message.get("bytes", ())]


def test_three_pages_at_once_one_slow_one_gone(address):
    with connect(address) as slow, connect(address) as gone, connect(address) as fast:
        for socket in (slow, gone, fast):
            socket.send(json.dumps({"type": "hello", "width": 64, "height": 64, "state": None}))
        gone.close()
        numbers = []
        while len(numbers) < 3:
            message, _ = receive(fast)
            if message["type"] == "picture":
                numbers.append(message["number"])
                fast.send(json.dumps({"type": "shown", "number": message["number"]}))
        assert numbers == [1, 2, 3]
        kinds = [receive(slow)[0]["type"] for _ in range(3)]  # it confirms nothing, and gets one
        assert kinds == ["open", "picture", "progress"]
        with pytest.raises(TimeoutError):
            slow.recv(timeout=0.5)


LONG_NUMBER = f'{{"type": {10**4000}{10**4000}}}'  # longer than Python reads


@pytest.mark.parametrize(
    "text",
    ["no JSON", "[1]", '{"type": "set"}', '{"bytes": "x"}', "[" * 10**6, LONG_NUMBER, b"\xff", ""],
    ids=lambda text: str(text)[:16],
)
def test_a_message_that_is_none_is_answered_by_a_sentence(address, text):
    with connect(address) as socket:
        socket.send(text)
        assert receive(socket)[0]["type"] == "error"
        assert receive(socket)[0]["type"] == "state"
        socket.send('{"type": "undo"}')
        assert receive(socket)[0]["type"] == "state"


def test_too_long_a_message_is_not_read(address):
    from websockets.exceptions import ConnectionClosed

    with connect(address) as socket:
        socket.send(bytes(server.LARGEST_MESSAGE + 1))
        with pytest.raises(ConnectionClosed, match="1009"):
            socket.recv(timeout=60)
    assert status(address) == 200


def test_a_page_that_is_gone_is_rendered_no_more(module_in_llvm, monkeypatch):
    threads, closed = [], threading.Event()
    monkeypatch.setattr(Session, "close", lambda _: closed.set())

    class Watched(RenderThread):
        def __init__(self):
            super().__init__()
            threads.append(self)

    monkeypatch.setattr(server, "RenderThread", Watched)
    make = partial(VolumeApplication, bk.volumes.load("smoke", size=8), "smoke")
    with server.serve(make, server.open_socket(0)) as address:
        with connect(address) as socket:
            socket.send('{"type": "undo"}')
            receive(socket)
            assert len(threads[0].sessions) == 1
        assert closed.wait(60)
        assert threads[0].sessions == {}


def test_a_taken_port_is_a_sentence():
    taken = server.open_socket(0)
    with pytest.raises(BrdfkitError, match="cannot be used"):
        server.open_socket(taken.getsockname()[1])
    taken.close()
