"""The server of a view: who is let in, what it sends, and that nothing of a request is a path."""

import contextlib
import json
from urllib.error import HTTPError
from urllib.request import Request, urlopen

import pytest

from brdfkit.core.errors import BrdfkitError
from brdfkit.viewing import server


def status(address, **headers):
    try:
        with urlopen(Request(address, headers=headers)) as answer:
            return answer.status
    except HTTPError as error:
        return error.code


def test_the_page_and_its_files_have_a_strict_policy(address):
    for name in ("", "page.js", "viewer.js", "viewer.css"):
        with urlopen(address + name) as answer:
            policy = answer.headers["Content-Security-Policy"]
            assert answer.read()
        assert policy.startswith("default-src 'none'")
        assert "unsafe" not in policy


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


@pytest.mark.parametrize("text", ["no JSON", "[1]", '{"type": "set"}', '{"bytes": "x"}'])
def test_a_message_that_is_none_harms_nobody(address, text):
    from websockets.exceptions import ConnectionClosed

    with connect(address) as socket:
        socket.send(text)
        with contextlib.suppress(ConnectionClosed):
            assert receive(socket)[0]["type"] in ("error", "state")
    assert status(address) == 200


def test_a_taken_port_is_a_sentence():
    taken = server.open_socket(0)
    taken.listen()
    with pytest.raises(BrdfkitError, match="cannot be used"):
        server.open_socket(taken.getsockname()[1])
    taken.close()
