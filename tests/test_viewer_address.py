"""Where the viewer listens: at this machine's own addresses only, and others than loopback are warned of."""

from __future__ import annotations

from pathlib import Path

import pytest

PENDULUM = Path(__file__).parents[1] / "examples" / "mechanisms" / "pendulum.yaml"


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (("--host", "192.0.2.7"), "--host: 192.0.2.7 is not an address of this machine"),
        (("--host", "2001:db8::7"), "--host: 2001:db8::7 is not an address of this machine"),
        (("--host", "here"), "--host: expected an IP address, found 'here'"),
        (("--port", "0"), "--port"),
        (("-o", "out.txt"), "a mechanism is saved as YAML"),
    ],
)
def test_refused(run, options, message):
    code, out, error = run("view", PENDULUM, "--no-open", *options)
    assert (code, out) == (2, "")
    assert message in error
