"""The page of a view on this computer: a small web server with one WebSocket per page.

The server listens to 127.0.0.1 alone. Every address contains a random token, and requests with the
`Host` or `Origin` of another site are refused, so that no other page in the browser can read a view
or send files to it. No part of a request becomes a path.
"""

from __future__ import annotations

import asyncio
import hmac
import json
import secrets
import socket
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from typing import Any, TypeVar, cast

from brdfkit.core.errors import BrdfkitError
from brdfkit.viewing.application import Application, Message
from brdfkit.viewing.drops import DropSession
from brdfkit.viewing.front_end import read_module, read_page_file
from brdfkit.viewing.render_thread import RenderThread
from brdfkit.viewing.session import Session

R = TypeVar("R")
HOST = "127.0.0.1"
LARGEST_MESSAGE = 2 << 20  # bytes: the page sends files in pieces of 1 MB
LONGEST_END = 0.3  # seconds for which the end waits for the server
POLICY = (
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob: data:; "
    "connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
)
HEADERS = {
    "Content-Security-Policy": POLICY,
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
    "Cache-Control": "no-store",
}


def require_server() -> None:
    """Raise `BrdfkitError` if the packages of the server are missing."""
    try:
        import starlette  # noqa: F401
        import uvicorn  # noqa: F401
        import websockets  # noqa: F401
    except ImportError as error:
        raise BrdfkitError(
            f"A view in the browser needs {error.name}, which is not installed: "
            'pip install "brdfkit[view]".'
        ) from None


def open_socket(port: int) -> socket.socket:
    """Return a socket on this computer; raise `BrdfkitError` if the port is taken."""
    listening = socket.socket()
    listening.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    try:
        listening.bind((HOST, port))
        listening.listen()  # only now a port that another program listens to is an error
    except (OSError, OverflowError) as error:
        listening.close()
        reason = getattr(error, "strerror", None) or error
        raise BrdfkitError(
            f"Port {port} of {HOST} cannot be used ({reason}); give another --port."
        ) from None
    return listening


def make_app(make_application: Callable[[], Application], port: int, token: str) -> Any:
    """Return the ASGI application that serves a view.

    `make_application` is called for each page, so that every page has a view of its own.
    """
    from starlette.applications import Starlette
    from starlette.exceptions import HTTPException
    from starlette.requests import Request
    from starlette.responses import PlainTextResponse, Response
    from starlette.routing import Route, WebSocketRoute
    from starlette.websockets import WebSocket

    thread = RenderThread()
    hosts = {f"{name}:{port}" for name in (HOST, "localhost")}
    origins = {f"http://{host}" for host in hosts}

    def is_allowed(connection: Request | WebSocket) -> bool:
        """Return whether a request comes from the view's own page."""
        given = connection.path_params.get("token", "")
        fine = hmac.compare_digest(given.encode(), token.encode())
        origin = connection.headers.get("origin")
        return fine and connection.headers.get("host") in hosts and origin in {None, *origins}

    async def serve_file(request: Request) -> Response:
        if not is_allowed(request):
            return PlainTextResponse("This is not the address of a view.", 403, HEADERS)
        name = request.path_params.get("name", "page.html")
        if name == "viewer.js":
            return Response(read_module(), 200, HEADERS, "text/javascript")
        kinds = {"page.html": "text/html", "page.js": "text/javascript", "viewer.css": "text/css"}
        if name not in kinds:
            return PlainTextResponse("There is no such file.", 404, HEADERS)
        return Response(read_page_file(name), 200, HEADERS, kinds[name])

    async def refuse(_: Request, error: Exception) -> Response:
        """Answer a request that no route takes, by Starlette's error, with the headers of all."""
        assert isinstance(error, HTTPException)
        return PlainTextResponse(
            error.detail, error.status_code, {**HEADERS, **(error.headers or {})}
        )

    async def serve_session(socket: WebSocket) -> None:
        if not is_allowed(socket) or socket.headers.get("origin") is None:
            await socket.close(1008)
            return
        await socket.accept()
        loop = asyncio.get_running_loop()
        outgoing: asyncio.Queue[Message] = asyncio.Queue()

        def send(message: Message) -> None:
            with suppress(RuntimeError):  # the server has ended meanwhile
                loop.call_soon_threadsafe(outgoing.put_nowait, message)

        session = DropSession(await run_aside(make_application))
        writer = asyncio.create_task(write_messages(socket, outgoing))
        thread.add(session, send)
        try:
            await read_messages(socket, session, thread, outgoing)
        finally:
            thread.remove(session)
            threading.Thread(target=session.close, daemon=True).start()  # it may wait for an answer
            writer.cancel()

    routes = [
        Route("/{token}/", serve_file),
        Route("/{token}/{name}", serve_file),
        WebSocketRoute("/{token}/session", serve_session),
    ]
    app = Starlette(routes=routes, exception_handlers={HTTPException: refuse})
    app.router.redirect_slashes = False  # which would answer before `is_allowed`
    app.state.thread = thread
    return app


async def run_aside(function: Callable[..., R], *arguments: Any) -> R:
    """Return the result of a function that takes long, from a thread of its own.

    The program's end does not wait for it, as it would for asyncio's own threads.
    """
    loop = asyncio.get_running_loop()
    done: asyncio.Future[R] = loop.create_future()

    def finish(result: R | None, error: BaseException | None) -> None:
        if done.cancelled():
            return
        if error is None:
            done.set_result(cast(R, result))
        else:
            done.set_exception(error)

    def work() -> None:
        outcome: tuple[R | None, BaseException | None]
        try:
            outcome = function(*arguments), None
        except BaseException as error:
            outcome = None, error
        with suppress(RuntimeError):  # the server has ended meanwhile
            loop.call_soon_threadsafe(finish, *outcome)

    threading.Thread(target=work, daemon=True).start()
    return await done


async def read_messages(socket: Any, session: Session, thread: RenderThread, outgoing: Any) -> None:
    """Answer the messages of a page until it is gone."""
    header: dict[str, Any] = {}  # a message whose bytes come next
    while (event := await socket.receive())["type"] == "websocket.receive":
        data = event.get("bytes")
        if data is not None:
            message, header = header, {}
        else:
            message = parse_message(event.get("text") or "")
            if isinstance(message.get("bytes"), list):
                header = message
                continue
        for answer in await run_aside(session.handle, message, data or b""):
            outgoing.put_nowait(answer)
        thread.wake()


def parse_message(text: str) -> dict[str, Any]:
    """Return a message of JSON; one without a type, which a session refuses, if it is none."""
    try:
        message = json.loads(text)
    except (ValueError, RecursionError):
        return {}
    return message if isinstance(message, dict) else {}


async def write_messages(socket: Any, outgoing: Any) -> None:
    """Send messages to a page: JSON with the sizes of the bytes that follow, then the bytes."""
    while True:
        message, buffers = await outgoing.get()
        try:
            sizes = {"bytes": [len(buffer) for buffer in buffers]} if buffers else {}
            await socket.send_text(json.dumps(message | sizes))
            for buffer in buffers:
                await socket.send_bytes(buffer)
        except RuntimeError:  # the page is gone
            return


@contextmanager
def serve(
    make_application: Callable[[], Application], listening: socket.socket, token: str = ""
) -> Iterator[str]:
    """Serve a view within the block, which gets its address.

    `make_application` is called for each page. Without a `token` the address gets a random one.
    """
    import uvicorn

    port, token = listening.getsockname()[1], token or secrets.token_urlsafe(16)
    app = make_app(make_application, port, token)
    config = uvicorn.Config(
        app,
        log_level="critical",
        lifespan="off",
        ws="websockets-sansio",
        ws_max_size=LARGEST_MESSAGE,
        timeout_graceful_shutdown=0,
    )
    server = uvicorn.Server(config)
    thread = threading.Thread(target=server.run, args=([listening],), daemon=True)
    thread.start()
    try:
        yield f"http://{HOST}:{port}/{token}/"
    finally:
        server.should_exit = True
        app.state.thread.stop()
        thread.join(LONGEST_END)
        listening.close()
