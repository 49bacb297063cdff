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
from collections.abc import Callable
from contextlib import suppress
from typing import Any

from brdfkit.core.errors import BrdfkitError
from brdfkit.viewing.application import Application, Message
from brdfkit.viewing.front_end import read_module, read_page_file
from brdfkit.viewing.render_thread import RenderThread
from brdfkit.viewing.session import Session

HOST = "127.0.0.1"
LARGEST_MESSAGE = 2 << 20  # bytes: the page sends files in pieces of 1 MB
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
    except (OSError, OverflowError) as error:
        listening.close()
        reason = getattr(error, "strerror", None) or error
        raise BrdfkitError(f"Port {port} cannot be used ({reason}); give another --port.") from None
    return listening


def make_app(make_application: Callable[[], Application], port: int, token: str) -> Any:
    """Return the ASGI application that serves a view.

    `make_application` is called for each page, so that every page has a view of its own.
    """
    from starlette.applications import Starlette
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

    async def serve_session(socket: WebSocket) -> None:
        if not is_allowed(socket) or socket.headers.get("origin") is None:
            await socket.close(1008)
            return
        await socket.accept()
        loop = asyncio.get_running_loop()
        outgoing: asyncio.Queue[Message] = asyncio.Queue()
        session = Session(await loop.run_in_executor(None, make_application))

        def send(message: Message) -> None:
            with suppress(RuntimeError):  # the server has ended meanwhile
                loop.call_soon_threadsafe(outgoing.put_nowait, message)

        writer = asyncio.create_task(write_messages(socket, outgoing))
        thread.add(session, send)
        try:
            await read_messages(socket, session, thread, outgoing)
        finally:
            thread.remove(session)
            writer.cancel()

    routes = [
        Route("/{token}/", serve_file),
        Route("/{token}/{name}", serve_file),
        WebSocketRoute("/{token}/session", serve_session),
    ]
    app = Starlette(routes=routes)
    app.state.thread = thread
    return app


async def read_messages(socket: Any, session: Session, thread: RenderThread, outgoing: Any) -> None:
    """Answer the messages of a page until it is gone."""
    from starlette.websockets import WebSocketDisconnect

    loop, header = asyncio.get_running_loop(), None
    try:
        while True:
            event = await socket.receive()
            if event["type"] != "websocket.receive":
                return
            data = event.get("bytes")
            if data is None:
                try:
                    message = json.loads(event.get("text") or "")
                except ValueError:
                    return
                if not isinstance(message, dict):
                    return
                if isinstance(message.get("bytes"), list):  # which come next
                    header = message
                    continue
            else:
                message, header = header or {}, None
            answers = await loop.run_in_executor(None, session.handle, message, data or b"")
            for answer in answers:
                outgoing.put_nowait(answer)
            thread.wake()
    except WebSocketDisconnect:
        return


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


def make_runner(app: Any) -> Any:
    """Return the `uvicorn.Server` that runs an ASGI application."""
    import uvicorn

    config = uvicorn.Config(
        app,
        log_level="critical",
        lifespan="off",
        ws="websockets-sansio",
        ws_max_size=LARGEST_MESSAGE,
        timeout_graceful_shutdown=0,
    )
    return uvicorn.Server(config)


def serve(
    make_application: Callable[[], Application],
    listening: socket.socket,
    ready: Callable[[str], None],
) -> None:
    """Serve a view until Ctrl-C; `ready` is called with its address."""
    port, token = listening.getsockname()[1], secrets.token_urlsafe(16)
    app = make_app(make_application, port, token)
    ready(f"http://{HOST}:{port}/{token}/")
    try:
        make_runner(app).run([listening])
    finally:
        app.state.thread.stop()
        listening.close()
