"""A real browser at the viewer's gate: other pages, other names and a missing token get nothing."""

from __future__ import annotations

from collections.abc import Iterator
from http.server import BaseHTTPRequestHandler, HTTPServer
from pathlib import Path
from threading import Thread
from typing import Any, ClassVar
from urllib.parse import urlsplit

import pytest
from peers import peer

import equipoise as eq

ARM = Path(__file__).parents[1] / "examples" / "mechanisms" / "pendulum.yaml"
ASK = """async ([page, protocol]) => {
    const got = {};
    try { got.page = (await (await fetch(page)).text()).length; } catch (error) { got.page = String(error.name); }
    got.blind = (await fetch(page, {mode: "no-cors"}).catch(() => ({type: "blocked"}))).type;
    got.frame = await new Promise(done => {
        const frame = document.createElement("iframe");
        frame.onload = () => { try { done(frame.contentDocument ? "ours" : "closed"); } catch { done("closed"); } };
        frame.src = page;
        document.body.append(frame);
    });
    got.socket = await new Promise(done => {
        const socket = new WebSocket(page.replace("http", "ws").replace(/\\/$/, ""), [protocol]);
        socket.onmessage = () => done("a message");
        socket.onclose = () => done("closed");
        setTimeout(() => done("nothing"), 10000);
    });
    return got;
}"""  # what a page may try that knows even the token


class Elsewhere(BaseHTTPRequestHandler):
    """An empty page of another origin, and what has been asked of it."""

    asked: ClassVar[list[str]] = []

    def do_GET(self) -> None:
        self.asked.append(self.path)
        self.send_response(200)
        self.send_header("Content-Type", "text/html")
        self.end_headers()
        self.wfile.write(b"<!doctype html><title>elsewhere</title><body></body>")

    def log_message(self, format: str, *args: object) -> None:
        """Nothing: the tests' output is theirs."""


@pytest.fixture(scope="module")
def viewer(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Any]:
    peer("viser")
    from equipoise.viewer.server import Viewer

    found = Viewer(eq.load(ARM), tmp_path_factory.mktemp("gate") / "mine.yaml", port=8150)
    yield found
    found.close()


@pytest.fixture(scope="module")
def elsewhere() -> Iterator[str]:
    server = HTTPServer(("127.0.0.1", 0), Elsewhere)
    thread = Thread(target=server.serve_forever)
    thread.start()
    yield f"http://127.0.0.1:{server.server_port}"
    server.shutdown()
    thread.join()
    server.server_close()


@pytest.mark.slow(reason="needs a browser")
def test_a_page_of_another_origin_gets_nothing_even_with_the_token(browser, viewer, elsewhere):
    import viser

    page = browser.new_page()
    page.goto(elsewhere)
    got = page.evaluate(ASK, [viewer.url, f"viser-v{viser.__version__}"])
    page.close()
    assert got == {"page": "TypeError", "blind": "blocked", "frame": "closed", "socket": "closed"}
    assert not viewer.server.get_clients()


def refused(browser: Any, address: str) -> None:
    """The browser gets a refusal without content at an address."""
    from playwright.sync_api import Error

    page, statuses, contents = browser.new_page(), [], []
    page.on("response", lambda response: statuses.append(response.status))
    page.on("response", lambda response: contents.append(response.headers.get("content-length")))
    with pytest.raises(Error, match="ERR_HTTP_RESPONSE_CODE_FAILURE"):
        page.goto(address)
    page.close()
    assert set(statuses) == {403}
    assert set(contents) == {"0"}


@pytest.mark.slow(reason="needs a browser")
def test_another_name_for_this_machine_gets_nothing(browser, viewer):
    """The browser takes every name under localhost to this machine, as an attacker's name server would."""
    address = urlsplit(viewer.url)
    refused(browser, f"http://rebound.localhost:{address.port}{address.path}")


@pytest.mark.slow(reason="needs a browser")
@pytest.mark.parametrize("path", ["/", "/index.html", "/wrong/"])
def test_a_missing_token_gets_nothing(browser, viewer, path):
    refused(browser, f"http://{urlsplit(viewer.url).netloc}{path}")


@pytest.mark.slow(reason="needs a browser")
def test_its_own_page_is_drawn_and_asks_nobody_else(browser, viewer, elsewhere):
    page = browser.new_page()
    against: list[str] = []
    page.on("console", lambda message: against.append(message.text) if "Content Security" in message.text else None)
    page.goto(viewer.url)
    page.wait_for_selector("[data-residual]", timeout=60_000)
    assert page.url.startswith(viewer.url)
    assert against == []
    page.goto(f"{viewer.url}?websocket={elsewhere.replace('http', 'ws')}/tricked")  # viser's page would ask there
    page.wait_for_timeout(3000)
    assert "/tricked" not in Elsewhere.asked
    page.close()
