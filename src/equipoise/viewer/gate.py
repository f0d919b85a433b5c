"""Who may open the viewer's page, and what the page may say.

viser serves everybody who reaches its port and takes every message: any page open in the user's browser could read and
change the design, or have viser open a tunnel to the internet. It has no hook for that. So `served` wraps the one call
with which viser begins to listen (`websockets.asyncio.server.serve`), while viser starts and never again, with what
that call offers itself: a look at each request, and a class for connections. A viser that starts otherwise is stopped.
"""

from __future__ import annotations

import secrets
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from http import HTTPStatus
from ipaddress import ip_address
from typing import TYPE_CHECKING, Any

from ..model.errors import InputError
from .messages import Messages

if TYPE_CHECKING:
    from websockets.asyncio.server import ServerConnection
    from websockets.http11 import Request, Response

LARGEST = 100_000  # bytes of a message from the page
LOCAL = "localhost"
HTTP = 80  # the port that a browser leaves out
POLICY = (
    "default-src 'self' 'unsafe-inline' 'unsafe-eval' data: blob:; connect-src 'self' data: blob: ws://{host}; "
    "frame-ancestors 'none'; base-uri 'none'; form-action 'none'"
)
HEADERS = {
    "Referrer-Policy": "no-referrer",  # the address holds the token
    "Cross-Origin-Resource-Policy": "same-origin",
    "Cross-Origin-Opener-Policy": "same-origin",
    "X-Content-Type-Options": "nosniff",
    "Cache-Control": "no-store",
}

Page = Callable[["ServerConnection", "Request"], "Response | None"]


class Gate:
    """Admits the page of one address: its host, its own origin and a random token as the first part of its path.

    Attributes:
        token: new for every viewer.
    """

    def __init__(self, host: str, protocol: str) -> None:
        self.host, self.protocol, self.token = host, protocol, secrets.token_urlsafe(32)

    def url(self, port: int) -> str:
        """Of the page; with a wildcard host, as this machine reaches it."""
        return f"http://{self._names(port, '::1' if ':' in self.host else '127.0.0.1')[-1]}/{self.token}/"

    def admit(self, page: Page, connection: ServerConnection, request: Request) -> Response | None:
        """What a request gets: nothing (403), a file of the page, or, as None, the socket."""
        refused = connection.respond(HTTPStatus.FORBIDDEN, "")
        address, port = connection.local_address[:2]
        hosts, origins, upgrades = (request.headers.get_all(name) for name in ("Host", "Origin", "Upgrade"))
        if len(hosts) != 1 or hosts[0].lower() not in self._names(port, address):
            return refused  # another name has been made to lead here
        if origins != [f"http://{hosts[0]}"] and (origins or upgrades):
            return refused  # a page from elsewhere asks
        path, mark, query = request.path.partition("?")
        first, _, rest = path.removeprefix("/").partition("/")
        if not secrets.compare_digest(first.encode(), self.token.encode()):
            return refused
        if upgrades and request.headers.get_all("Sec-WebSocket-Protocol") != [self.protocol]:
            return refused
        response = page(connection, replace(request, path=f"/{rest}{mark}{query}"))
        if response is not None:
            response.headers.update({**HEADERS, "Content-Security-Policy": POLICY.format(host=hosts[0])})
        return response

    def _names(self, port: int, address: str) -> list[str]:
        """What a browser may call us in the Host header."""
        if self.host == LOCAL:
            name = LOCAL
        else:
            own = ip_address(self.host)
            if own.is_unspecified:  # any address of this machine, but no name: only names can be made to lead here
                own = ip_address(address.partition("%")[0])
                own = getattr(own, "ipv4_mapped", None) or own
            name = f"[{own.compressed}]" if own.version == 6 else own.compressed
        return [name, f"{name}:{port}"] if port == HTTP else [f"{name}:{port}"]


def served(viser: Any, host: str, port: int, label: str) -> tuple[Any, Gate, Messages]:
    """A viser server that listens behind a gate, which hears no message yet: `Messages.hear` opens it.

    Raises:
        InputError: this version of viser starts in a way that cannot be guarded.
    """
    gate, messages = Gate(host, f"viser-v{viser.__version__}"), Messages()
    with quiet(), _guarded(gate, messages) as guarded:
        server = viser.ViserServer(host=host, port=port, label=label, verbose=False)
        if not guarded:
            server.stop()
            raise InputError(f"viser {viser.__version__} cannot be guarded: install the version of constraints.txt")
    return server, gate, messages


@contextmanager
def _guarded(gate: Gate, messages: Messages) -> Iterator[list[Any]]:
    """While it lasts, servers of websockets stand behind the gate; gives those that have."""
    import logging

    from websockets.asyncio import server

    log = logging.Logger("equipoise.viewer")  # of its own, and silent: what strangers send is nobody's traceback
    log.addHandler(logging.NullHandler())
    serve, begun = server.serve, []

    class Listened(server.ServerConnection):
        async def recv(self, decode: bool | None = None) -> Any:
            while True:
                data = await super().recv(decode)
                if messages.passes(data):
                    return data

    def behind(handler: Any, host: Any, port: Any, *, process_request: Page, **options: Any) -> Any:
        options |= {"max_size": LARGEST, "logger": log, "create_connection": Listened}
        begun.append(host)
        return serve(
            handler, host, port, process_request=lambda *asked: gate.admit(process_request, *asked), **options
        )  # fmt: skip

    server.serve = behind  # type: ignore[assignment,misc]
    try:
        yield begun
    finally:
        server.serve = serve


@contextmanager
def quiet() -> Iterator[None]:
    """viser announces an address without the token, which lets nobody in."""
    import rich

    console = rich.get_console()
    before, console.quiet = console.quiet, True
    try:
        yield
    finally:
        console.quiet = before
