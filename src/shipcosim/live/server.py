"""The server of a running system: its page, and a WebSocket on which rows go out and changes come in.

It answers to programs of this machine only, and to those that know the token in its address. It refuses what another
site's page could ask for: requests under another host name, from another origin, or without the token.
"""

from __future__ import annotations

import asyncio
import hmac
import queue
import secrets
import threading
from contextlib import suppress
from http import HTTPStatus
from typing import Any, Self

from shipcosim.errors import imported

with imported(
    "shipcosim live", "It needs the library websockets where no page can run the system.", "live"
):
    from websockets.asyncio.server import ServerConnection, broadcast, serve
    from websockets.datastructures import Headers
    from websockets.exceptions import ConnectionClosed
    from websockets.http11 import Request, Response

ADDRESS = "127.0.0.1"
LARGEST = 1 << 20
"""Size of a message that a page may send. [B]"""
LONGEST_END = 1.0
"""Time that pages have to take their leave at the end. [s]"""
TAKE_OVER = '{"do":"steer"}'
"""What a page that reads sends to steer."""
NOT_ALLOWED = 1008
"""Code of WebSocket with which a connection is closed that asks for what there is not."""
POLICY = (
    "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data: blob:; "
    "connect-src {}; frame-ancestors 'none'; base-uri 'none'; form-action 'none'"
)


class LiveServer:
    """A server of one page, in a thread of its own within a ``with`` statement.

    Parameters
    ----------
    page : str
        HTML.

    Attributes
    ----------
    inbox : Queue of (str, page, str)
        What happened: a page has "joined" or "left", or has "asked" for what a text says. Of several pages only the
        first steers. The others read; they can only ask to take over, once nobody steers.
    url : str
        Address of the page, with its token.
    """

    def __init__(self, page: str):
        self._page = page.encode()
        self._token = secrets.token_urlsafe(24)
        self._steering: ServerConnection | None = None
        self._joined: set[ServerConnection] = set()
        self.inbox: queue.Queue[tuple[str, Any, str]] = queue.Queue()

    def __enter__(self) -> Self:
        ready = threading.Event()
        self._thread = threading.Thread(target=lambda: asyncio.run(self._serve(ready)), daemon=True)
        self._thread.start()
        ready.wait()
        return self

    def __exit__(self, *_: object) -> None:
        self._loop.call_soon_threadsafe(self._end.set)
        self._thread.join()

    async def _serve(self, ready: threading.Event) -> None:
        self._loop = asyncio.get_running_loop()
        self._end = asyncio.Event()
        # Rows of numbers hardly shrink, and nothing leaves this machine: no compression.
        options: dict[str, Any] = {"compression": None, "max_size": LARGEST, "server_header": None}
        server = await serve(self._converse, ADDRESS, 0, process_request=self._answer, **options)
        port = server.sockets[0].getsockname()[1]
        self._hosts = {f"{ADDRESS}:{port}", f"localhost:{port}"}
        self.url = f"http://{ADDRESS}:{port}/{self._token}/"
        ready.set()
        await self._end.wait()
        # Browsers hold connections open that they do not use, and would be waited for.
        server.close()
        with suppress(TimeoutError):
            await asyncio.wait_for(server.wait_closed(), LONGEST_END)

    # ---- requests

    def _answer(self, connection: ServerConnection, request: Request) -> Response | None:
        """The page, or a refusal that tells nothing; None lets a WebSocket through."""
        headers = request.headers
        is_socket = bool(headers.get_all("Upgrade"))
        if not self._is_ours(request, is_socket):
            return connection.respond(HTTPStatus.FORBIDDEN, "Forbidden\n")
        if is_socket:
            return None
        content = {
            "Content-Type": "text/html; charset=utf-8",
            "Content-Length": str(len(self._page)),
            "Content-Security-Policy": POLICY.format(
                " ".join(f"ws://{host}" for host in sorted(self._hosts))
            ),
            "Referrer-Policy": "no-referrer",
            "X-Content-Type-Options": "nosniff",
            "Cross-Origin-Resource-Policy": "same-origin",
            "Cache-Control": "no-store",
            "Connection": "close",
        }
        return Response(HTTPStatus.OK, "OK", Headers(content), self._page)

    def _is_ours(self, request: Request, is_socket: bool) -> bool:
        """True for a request with our token and host name that no other site's page has made."""
        hosts = request.headers.get_all("Host")
        origins = request.headers.get_all("Origin")
        sites = request.headers.get_all("Sec-Fetch-Site")
        token = hmac.compare_digest(request.path.encode(), f"/{self._token}/".encode())
        is_named = len(hosts) == 1 and hosts[0] in self._hosts
        # A browser tells the origin of every WebSocket; to a page that is typed or clicked in a terminal none belongs.
        is_same = origins == [f"http://{hosts[0]}"] if is_named else False
        return (
            token
            and is_named
            and (is_same or not (origins or is_socket))
            and set(sites) <= {"none", "same-origin"}
        )

    async def _converse(self, connection: ServerConnection) -> None:
        """Serve one page, from its connection to its end."""
        if self._steering is None:
            self._steering = connection
        self.inbox.put(("joined", connection, ""))
        try:
            with suppress(ConnectionClosed):
                async for message in connection:
                    if self._steering is None and message == TAKE_OVER:
                        # It starts with the whole run, as a page that has just come.
                        self._steering = connection
                        self.inbox.put(("joined", connection, ""))
                    elif connection is self._steering and isinstance(message, str):
                        self.inbox.put(("asked", connection, message))
        finally:
            self._joined.discard(connection)
            if connection is self._steering:
                self._steering = None
                self.inbox.put(("left", connection, ""))

    # ---- what the run tells: see `Pages`

    def steers(self, page: Any) -> bool:
        """See `Pages.steers`."""
        return page is self._steering

    def refuse(self, page: Any) -> None:
        """See `Pages.refuse`."""
        asyncio.run_coroutine_threadsafe(page.close(NOT_ALLOWED), self._loop)

    def send(self, *messages: str | bytes, to: Any = None) -> None:
        """See `Pages.send`."""
        self._loop.call_soon_threadsafe(self._send, messages, to)

    def _send(self, messages: tuple[str | bytes, ...], to: ServerConnection | None) -> None:
        # A broadcast never waits: a slow page delays neither the run nor the others.
        for message in messages:
            broadcast({to} if to is not None else self._joined, message)
        if to is not None and to.close_code is None:
            self._joined.add(to)
