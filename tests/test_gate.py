"""The viewer's gate: nobody but its own page gets in, and the page may only say what its controls can."""

from __future__ import annotations

import http.client
import math
from collections.abc import Iterator
from contextlib import closing, contextmanager
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import numpy as np
import pytest
from peers import peer

import equipoise as eq
from equipoise.io import yaml

ARM = Path(__file__).parents[1] / "examples" / "mechanisms" / "lin2010_balanced.yaml"
CAMERA = {
    "type": "ViewerCameraMessage", "wxyz": [1, 0, 0, 0], "position": [0.0, 0.0, 1.0], "fov": 1, "near": 0.1,
    "far": 100, "image_height": 600, "image_width": 800, "look_at": [0, 0, 0], "up_direction": [0, 0, 1],
}  # fmt: skip


@pytest.fixture(scope="module")
def viewer(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Any]:
    peer("viser")
    from equipoise.viewer.server import Viewer

    found = Viewer(eq.load(ARM), tmp_path_factory.mktemp("gate") / "mine.yaml", port=8130)
    yield found
    found.close()


@pytest.fixture
def address(viewer: Any) -> Any:
    return urlsplit(viewer.url)


def asked(address: Any, path: str, **headers: str) -> tuple[int, bytes, Any]:
    """The status, the content and the headers that a request gets."""
    with closing(http.client.HTTPConnection("127.0.0.1", address.port, timeout=10)) as connection:
        connection.request("GET", path, headers=headers)
        answer = connection.getresponse()
        return answer.status, answer.read(), answer.headers


@contextmanager
def socket(address: Any, origin: str | None = None, path: str | None = None, protocol: str = "") -> Iterator[Any]:
    """A WebSocket to the viewer; with its own origin, path and protocol where nothing else is said."""
    import viser
    from websockets.sync.client import connect

    own = f"http://{address.netloc}"
    names: list[Any] = [protocol or f"viser-v{viser.__version__}"]
    with connect(
        f"ws://{address.netloc}{address.path.rstrip('/') if path is None else path}",
        origin=origin if origin is not None else own,  # type: ignore[arg-type]
        subprotocols=names, open_timeout=10, max_size=None,
    ) as found:  # fmt: skip
        yield found


def test_the_page_is_served_and_loads_nothing_from_elsewhere(viewer, address):
    status, content, headers = asked(address, address.path)
    assert status == 200
    assert len(content) > 100_000
    policy = headers["Content-Security-Policy"]
    assert f"connect-src 'self' data: blob: ws://{address.netloc};" in policy
    assert "frame-ancestors 'none'" in policy


def test_tokens_are_long_and_new_every_time(viewer, address, tmp_path):
    from equipoise.viewer.server import Viewer

    other = Viewer(eq.load(ARM), tmp_path / "mine.yaml", port=8130)
    other.close()
    tokens = {address.path.strip("/"), urlsplit(other.url).path.strip("/")}
    assert len(tokens) == 2
    assert all(len(token) >= 40 for token in tokens)


@pytest.mark.parametrize("path", ["/", "/index.html", "/wrong/", "/%2e%2e/", "//", "/é", "?token=", "/TOKEN/../"])
def test_a_wrong_token_gets_nothing(viewer, address, path):
    path = path.replace("TOKEN", address.path.strip("/")[:-1] + "~").replace("é", "%C3%A9")
    assert asked(address, path or "/")[:2] == (403, b"")


@pytest.mark.parametrize(
    "host", ["evil.example", "evil.example:PORT", "localhost:PORT", "127.0.0.1", "127.0.0.1:1", "[::1]:PORT", ""]
)
def test_another_host_gets_nothing(viewer, address, host):
    assert asked(address, address.path, Host=host.replace("PORT", str(address.port)))[:2] == (403, b"")


@pytest.mark.parametrize("origin", ["http://evil.example", "null", "https://127.0.0.1:PORT", "http://127.0.0.1:1", ""])
def test_another_origin_gets_nothing(viewer, address, origin):
    from websockets.exceptions import InvalidStatus

    origin = origin.replace("PORT", str(address.port))
    assert asked(address, address.path, Origin=origin)[:2] == (403, b"")
    with pytest.raises(InvalidStatus, match="403"), socket(address, origin):
        pass


@pytest.mark.parametrize("how", [{"path": ""}, {"path": "/wrong"}, {"protocol": "viser-v0"}])
def test_a_socket_needs_the_token_and_the_pages_version(viewer, address, how):
    from websockets.exceptions import InvalidStatus

    with pytest.raises(InvalidStatus, match="403"), socket(address, **how):
        pass


def test_what_is_no_request_gets_nothing_and_says_nothing(viewer, address, capfd):
    import socket as sockets

    for data in (
        b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03",
        b"GET\r\n\r\n",
        b"\0" * 100_000,
        b"POST / HTTP/1.1\r\n\r\n",
    ):
        with sockets.create_connection(("127.0.0.1", address.port), timeout=10) as raw:
            raw.sendall(data)
            raw.shutdown(sockets.SHUT_WR)
            received = b""
            while part := raw.recv(65536):
                received += part
            assert b"viser" not in received
    assert "Traceback" not in capfd.readouterr().err
    assert asked(address, address.path)[0] == 200


def control(viewer: Any, label: str) -> str:
    """The number of the control with this label."""
    handles = viewer.server.gui._gui_input_handle_from_uuid
    return next(uuid for uuid, handle in handles.items() if getattr(handle, "label", None) == label)


def messages(viewer: Any) -> dict[str, Any]:
    """Name -> a message that must be ignored."""
    labels = ("stiffness [N/m]", "motion", "payload [kg]", "a [mm]", "springs on", "Save to mine.yaml")
    stiffness, motion, payload, point, on, again = (control(viewer, label) for label in labels)
    joint = control(viewer, viewer.panel.sliders[0][0].label)

    def update(uuid: str, value: Any) -> dict[str, Any]:
        return {"type": "GuiUpdateMessage", "uuid": uuid, "updates": {"value": value}}

    wrong = (1e308, -1.0, 0.0, math.nan, math.inf, -math.inf, 2**63, True, None, "100", [100.0], {"a": 1})
    return {
        **{f"stiffness {value!r}": update(stiffness, value) for value in wrong},
        **{f"payload {value!r}": update(payload, value) for value in (1e308, math.nan, -1e-3)},
        **{f"pose {value!r}": update(joint, value) for value in (math.nan, 1e5)},
        **{f"motion {value!r}": update(motion, value) for value in ("unknown", 1, None, ["lin2010"])},
        **{f"point {value!r}": update(point, value) for value in ([math.nan, 0, 0], [0, 0], [1e308, 0, 0], 5, "abc")},
        **{f"switch {value!r}": update(on, value) for value in (0, "False", None)},
        "another property": {"type": "GuiUpdateMessage", "uuid": stiffness, "updates": {"max": 1e308}},
        "two properties": {"type": "GuiUpdateMessage", "uuid": stiffness, "updates": {"value": 100.0, "removed": True}},
        "another file": {"type": "GuiUpdateMessage", "uuid": again, "updates": {"label": "/etc/passwd"}},
        "a key that is no text": {"type": "GuiUpdateMessage", "uuid": stiffness, "updates": {1: 2}},
        "no control": update("nothing", 1.0),
        "a tunnel": {"type": "ShareUrlRequest"},
        "an upload": {
            "type": "FileTransferStartUpload", "source_component_uuid": again, "transfer_uuid": "a", "filename": "x",
            "mime_type": "x", "part_count": 1, "size_bytes": 1,
        },
        "a script": {"type": "RunJavascriptMessage", "source": "1"},
        "an unknown one": {"type": "\x1b[31mred"},
        "no type": {"a": 1},
        "a list": [1, 2],
        "a number": 1,
        "a camera of NaN": {**CAMERA, "position": [math.nan, 0.0, 0.0]},
        "a camera of two": {**CAMERA, "position": [0.0, 0.0]},
        "a camera without": {key: value for key, value in CAMERA.items() if key != "fov"},
        "a handle of NaN": {
            "type": "TransformControlsUpdateMessage", "name": "/handle0", "wxyz": [1, 0, 0, 0],
            "position": [math.nan, 0, 0], "owner": "",
        },
    }  # fmt: skip


def test_messages_that_mean_nothing_are_ignored_with_one_line(viewer, address, capfd):
    import msgspec

    saved = yaml.to_text(viewer.model.saved())
    pose = viewer.model.q.copy()
    capfd.readouterr()
    with socket(address) as found:
        found.send(msgspec.msgpack.encode(CAMERA))
        for message in messages(viewer).values():
            found.send(msgspec.msgpack.encode(message))
        for raw in (b"", b"\xc1", b"\x81" * 50_000, b"not msgpack"):
            found.send(raw)
        found.send("text")
        # the connection is still open, and a good message is still heard
        stiffness = viewer.panel.springs.sliders[0]
        wanted = round(0.8 * stiffness.value / stiffness.step) * stiffness.step
        assert yaml.to_text(viewer.model.saved()) == saved
        update = {"type": "GuiUpdateMessage", "uuid": control(viewer, stiffness.label), "updates": {"value": wanted}}
        found.send(msgspec.msgpack.encode(update))
        for _ in range(1000):
            if abs(viewer.model.springs[0].stiffness - wanted) < 1e-9:
                break
            found.recv(timeout=30)
    assert viewer.model.springs[0].stiffness == pytest.approx(wanted)
    assert np.array_equal(viewer.model.q, pose)
    viewer.model.change(0, stiffness=eq.load(ARM).springs[0].stiffness)
    _, lines = capfd.readouterr()
    assert "Traceback" not in lines
    assert "\x1b" not in lines
    assert "viewer: ignored an unknown message 'ShareUrlRequest'\n" in lines
    assert "viewer: ignored a value for 'stiffness [N/m]' that is out of its range\n" in lines
    assert all(line.startswith("viewer: ignored ") for line in lines.splitlines())
    assert len(set(lines.splitlines())) == len(lines.splitlines()) <= 20


def test_every_such_message_is_refused_on_its_own(viewer):
    import msgspec

    from equipoise.viewer.messages import Messages

    heard = Messages()
    heard.hear(viewer.server)
    passed = [
        name for name, message in messages(viewer).items() if heard.objection(msgspec.msgpack.encode(message)) is None
    ]
    assert passed == []
    handle = {"type": "TransformControlsUpdateMessage", "name": "/handle0", "wxyz": [1, 0, 0, 0], "position": [0, 0, 1]}
    for good in (CAMERA, handle | {"owner": ""}, {"type": "TransformControlsDragEndMessage", "name": "a", "owner": ""}):
        assert heard.objection(msgspec.msgpack.encode(good)) is None


def test_a_message_that_is_too_long_ends_the_connection(viewer, address):
    from websockets.exceptions import ConnectionClosed

    with socket(address) as found:
        found.send(b"\0" * 200_000)
        with pytest.raises(ConnectionClosed):
            list(found)
    assert asked(address, address.path)[0] == 200


def test_a_viser_that_starts_otherwise_is_not_served(monkeypatch, tmp_path):
    from types import SimpleNamespace

    from equipoise.model.errors import InputError
    from equipoise.viewer import gate

    stopped: list[bool] = []
    other = SimpleNamespace(
        __version__="9.9.9", ViserServer=lambda **_: SimpleNamespace(stop=lambda: stopped.append(True))
    )
    with pytest.raises(InputError, match=r"viser 9\.9\.9 cannot be guarded"):
        gate.served(other, "127.0.0.1", 8130, "arm")
    assert stopped == [True]


@pytest.mark.parametrize(
    ("host", "port", "local", "names"),
    [
        ("127.0.0.1", 8080, "127.0.0.1", ["127.0.0.1:8080"]),
        ("127.0.0.1", 80, "127.0.0.1", ["127.0.0.1", "127.0.0.1:80"]),
        ("localhost", 8080, "127.0.0.1", ["localhost:8080"]),
        ("::1", 8080, "::1", ["[::1]:8080"]),
        ("0:0:0:0:0:0:0:1", 8080, "::1", ["[::1]:8080"]),
        ("0.0.0.0", 8080, "192.0.2.7", ["192.0.2.7:8080"]),
        ("::", 8080, "::ffff:192.0.2.7", ["192.0.2.7:8080"]),
        ("::", 8080, "fe80::1%eth0", ["[fe80::1]:8080"]),
    ],
)
def test_names_that_a_browser_may_use(host, port, local, names):
    from equipoise.viewer.gate import Gate

    assert Gate(host, "viser")._names(port, local) == names
