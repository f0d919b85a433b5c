"""Runs the viewer: a page on this machine, or on another address with a warning."""

from __future__ import annotations

import os
import socket
import warnings
from ipaddress import ip_address
from pathlib import Path
from typing import Any

from ..io import Source, check_savable, loaded
from ..model.errors import EquipoiseWarning, Fault, InputError
from .gate import quiet, served

HOST, PORT = "127.0.0.1", 8080
LOCAL = "localhost"


class Viewer:
    """A running viewer; `close` ends it.

    Attributes:
        model, scene, panel: its parts.
        url: of the page; who knows it may change the design and save it.
    """

    def __init__(
        self,
        mechanism: Source,
        output: str | os.PathLike[str],
        *,
        host: str = HOST,
        port: int = PORT,
        source: str | os.PathLike[str] | None = None,
    ) -> None:
        """Start it.

        Args:
            mechanism: or the path of its file.
            output: the YAML file that the page's button saves to: nothing else is ever written.
            port: the next free one is taken where it is in use.
            source: the file that the mechanism is from: the meshes that a URDF names are drawn.

        Raises:
            InputError: viser is not installed, `output` cannot be written, `host` is not this machine's, or the
                mechanism's loops cannot be closed.
        """
        viser = load_viser()
        check_savable(output)
        local = loopback(host)
        own_address(host)
        if not local:
            warnings.warn(
                f"the viewer listens on {host}, unencrypted: whoever learns the page's address, or listens in on the "
                "network, can change the design and save it",
                EquipoiseWarning,
                stacklevel=2,
            )
        from .meshes import pictures
        from .model import Model
        from .panel import Panel
        from .scene import Scene

        mechanism = loaded(mechanism)
        self.model = Model(mechanism)
        self.server, gate, messages = served(viser, host, port, mechanism.name)
        self.server.gui.configure_theme(
            control_width="large", show_logo=False, show_share_button=False, brand_color=(0, 92, 150)
        )
        self.scene = Scene(self.server, self.model, pictures(source) if source is not None else ())
        self.panel = Panel(self.server, self.model, self.scene, Path(output))
        messages.hear(self.server)
        self.url = gate.url(self.server.get_port())

    def close(self) -> None:
        self.panel.playing = False
        with quiet():
            self.server.stop()


def loopback(host: str) -> bool:
    """Whether only this machine reaches the address.

    Raises:
        InputError: it is neither an IP address nor localhost.
    """
    if host == LOCAL:
        return True
    try:
        return ip_address(host).is_loopback
    except ValueError:
        raise InputError(Fault(("--host",), f"expected an IP address, found '{host}'", (HOST, LOCAL))) from None


def own_address(host: str) -> None:
    """Ask for a port there: the server itself would wait for ever where it cannot have one.

    Raises:
        InputError: it is no address of this machine.
    """
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    with socket.socket(family, socket.SOCK_STREAM) as found:
        try:
            found.bind((HOST if host == LOCAL else host, 0))
        except OSError:
            message = f"{host} is not an address of this machine"
            raise InputError(Fault(("--host",), message, (HOST, LOCAL))) from None


def load_viser() -> Any:
    """The package viser.

    Raises:
        InputError: it is not installed.
    """
    try:
        import viser
    except ImportError:
        raise InputError("the viewer needs viser: pip install 'equipoise[view]'") from None
    return viser
