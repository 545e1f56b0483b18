"""The page of a study with a server: a click on a row simulates it, one at a time.

The server gives the files of one folder to programs of this machine only. It refuses requests that
another site's page could make: under another host name, and simulations without our header, for
which a browser asks the server first.
"""

from __future__ import annotations

import io
import json
import mimetypes
import os
import re
import shutil
import sys
import threading
from collections.abc import Callable, Collection
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any, BinaryIO
from urllib.parse import unquote, urlsplit

from shipcosim.errors import ShipcosimError, error_at

ADDRESS = "127.0.0.1"
HEADER = "X-Shipcosim"
SLOWEST = 30.0
"""Time that a request may take to arrive. [s]"""
MOST_WAITING = 1024
"""Requests that may wait for the server to take them; the system may allow fewer. At 5, Python's default, 200 requests
at once left 74 without an answer for 20 s: the system drops what finds no room, and asks again ever later."""
SHOWN = {".html", ".csv", ".json", ".parquet", ".nc", ".png", ".svg", ".txt"}
"""Endings of the files that are served."""
RUN = re.compile(r"/run/([0-9]{1,9})")
POLICY = (
    "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data: blob:; "
    "connect-src 'self' blob:; frame-ancestors 'none'; base-uri 'none'; form-action 'none'"
)


class StudyServer(ThreadingHTTPServer):
    """A server of one study's folder.

    Parameters
    ----------
    folder : Path
        Of the study's results; ``report.html`` in it is its page.
    runs : collection of int
        Numbers of the runs that there are.
    simulate : callable
        Takes a number, leaves ``run-N/report.html`` in the folder; a ShipcosimError is shown on the page.
    port : int
        0: one that is free.
    """

    daemon_threads = True
    allow_reuse_address = False
    request_queue_size = MOST_WAITING

    def __init__(
        self, folder: Path, runs: Collection[int], simulate: Callable[[int], object], port: int = 0
    ):
        self.folder = folder.resolve()
        self.runs = frozenset(runs)
        self.simulate = simulate
        self.at_work = threading.Lock()
        super().__init__((ADDRESS, port), _Handler)

    def handle_error(self, request: Any, client_address: Any) -> None:
        """Report an error, except for a browser that did not wait for its answer."""
        if not isinstance(sys.exception(), ConnectionError):
            super().handle_error(request, client_address)

    @property
    def url(self) -> str:
        """Address of the page."""
        return f"http://{ADDRESS}:{self.server_port}/"

    def pages(self) -> list[int]:
        """Runs that have a page."""
        return sorted(run for run in self.runs if page_of_run(self.folder, run).is_file())


def study_server(
    folder: Path, runs: Collection[int], simulate: Callable[[int], object], port: int = 0
) -> StudyServer:
    """A server; ``serve_forever()`` runs it.

    Raises
    ------
    ShipcosimError
        If there is no page in the folder, or the port is taken.
    """
    if not (folder / "report.html").is_file():
        raise error_at(str(folder), "There is no report.html to be shown.", "Run the study first.")
    try:
        return StudyServer(folder, runs, simulate, port)
    except (OSError, OverflowError) as error:
        raise error_at(
            "--port",
            f"Port {port} cannot be used: {getattr(error, 'strerror', None) or error}.",
            "Choose another, or leave it to the system.",
        ) from error


def page_of_run(folder: Path, run: int) -> Path:
    """Path of the page of one run.

    Examples
    --------
    >>> page_of_run(Path("results"), 7).as_posix()
    'results/run-7/report.html'
    """
    return folder / f"run-{run}" / "report.html"


class _Handler(BaseHTTPRequestHandler):
    """One request."""

    server: StudyServer
    timeout = SLOWEST
    server_version = "shipcosim"
    sys_version = ""

    def do_GET(self) -> None:
        # Requests under another host name come from another site.
        path = urlsplit(self.path).path
        if not self._is_ours():
            return
        if path == "/study-server":
            self._answer(HTTPStatus.OK, {"pages": self.server.pages()})
        elif file := self._file(path):
            with file.open("rb") as body:
                self._send(
                    HTTPStatus.OK,
                    body,
                    mimetypes.guess_type(file.name)[0] or "application/octet-stream",
                )
        else:
            self._refuse(HTTPStatus.NOT_FOUND, "There is no such file in the folder of this study.")

    do_HEAD = do_GET

    def do_POST(self) -> None:
        # Only our page may start a simulation: its header, and its origin.
        if not self._is_ours():
            return
        if (
            self.headers.get(HEADER) != "run"
            or self.headers.get("Origin", self._origin()) != self._origin()
        ):
            self._refuse(
                HTTPStatus.FORBIDDEN, "Only the page of this study may ask for a simulation."
            )
            return
        # The number must be that of a run of this study.
        match = RUN.fullmatch(self.path)
        if not match or int(match[1]) not in self.server.runs:
            self._refuse(HTTPStatus.NOT_FOUND, "There is no such run in this study.")
            return
        self._simulate(int(match[1]))

    def _simulate(self, run: int) -> None:
        """Simulate a run that has no page yet, unless another simulation is running."""
        # One simulation at a time: the machine has few cores.
        page = page_of_run(self.server.folder, run)
        if not self.server.at_work.acquire(blocking=False):
            self._refuse(
                HTTPStatus.CONFLICT,
                "Another run is being simulated; one at a time. Try again when it is done.",
            )
            return
        try:
            wrong = self._without_page(run, page)
        finally:
            self.server.at_work.release()  # before it answers: whoever has the answer may ask again
        if wrong:
            self._refuse(HTTPStatus.INTERNAL_SERVER_ERROR, wrong)
        else:
            self._answer(HTTPStatus.OK, {"page": page.relative_to(self.server.folder).as_posix()})

    def _without_page(self, run: int, page: Path) -> str:
        """Simulate a run without a page; return why it has none afterwards."""
        if not (self.server.folder / "report.html").is_file():
            return f"{self.server.folder} has been moved or removed; a run would make it again."
        # Errors are shown on the page; the server goes on.
        try:
            if not page.is_file():
                self.server.simulate(run)
        except ShipcosimError as error:
            return "\n".join(map(str, error.problems))
        except Exception as error:  # a fault of ours is shown, and the server stays
            return f"run {run}: {type(error).__name__}: {error}"
        return "" if page.is_file() else f"run {run}: Its simulation left no page."

    def _origin(self) -> str:
        return f"http://{self.headers.get('Host')}"

    def _is_ours(self) -> bool:
        """True if the request uses this server's name; other names may be another site's."""
        port = self.server.server_port
        names = [f"{ADDRESS}:{port}"], [f"localhost:{port}"]
        # One name only, and none in the address, which would count instead of it.
        if self.headers.get_all("Host") in names and self.path.startswith("/"):
            return True
        self._refuse(HTTPStatus.FORBIDDEN, f"This server answers to {ADDRESS}:{port} only.")
        return False

    def _file(self, path: str) -> Path | None:
        """A file of the folder, at most one folder deep; None for all else, links out included."""
        # Plain names only: no dots, no deeper folders.
        parts = unquote(path).strip("/").split("/") if path != "/" else ["report.html"]
        if len(parts) > 2 or any(not re.fullmatch(r"\w[\w.-]*", part, re.ASCII) for part in parts):
            return None
        # Resolved, so that links cannot lead out of the folder.
        file = self.server.folder.joinpath(*parts).resolve()
        is_inside = file.is_relative_to(self.server.folder) and file.suffix in SHOWN
        return file if is_inside and file.is_file() else None

    def _refuse(self, status: HTTPStatus, why: str) -> None:
        self._answer(status, {"error": why})

    def _answer(self, status: HTTPStatus, content: object) -> None:
        self._send(status, io.BytesIO(json.dumps(content).encode()), "application/json")

    def _send(self, status: HTTPStatus, body: BinaryIO, kind: str) -> None:
        # The size first, then the content piece by piece: many may ask for a large page at once.
        size = body.seek(0, os.SEEK_END)
        body.seek(0)
        self.close_connection = True  # whatever else was sent is not read as another request
        self.send_response(status)
        for name, value in {
            "Content-Type": f"{kind}; charset=utf-8" if kind.startswith("text/") else kind,
            "Content-Length": str(size),
            "Content-Security-Policy": POLICY,
            "X-Content-Type-Options": "nosniff",
            "Cross-Origin-Resource-Policy": "same-origin",
            "Cache-Control": "no-store",
            "Connection": "close",
        }.items():
            self.send_header(name, value)
        self.end_headers()
        if self.command != "HEAD":
            shutil.copyfileobj(body, self.wfile)

    def log_message(self, format: str, *args: object) -> None:
        """Log nothing: the terminal shows only what matters."""
