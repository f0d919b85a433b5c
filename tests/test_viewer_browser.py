"""The viewer in a real browser: what a user touches moves, improves and is saved, and nothing leaves this machine."""

from __future__ import annotations

import re
import socket
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import numpy as np
import pytest
from browser import PATIENCE, opened, wait_until
from peers import peer
from robots import balanced

import equipoise as eq
from equipoise.kinematics.sampling import inside
from equipoise.model.mechanism import Mechanism
from equipoise.viewer import messages

FOLDER = Path(__file__).parents[1] / "examples" / "mechanisms"
EXAMPLES = ("ur5", "lin2010_balanced", "delta_balanced", "bevel_balanced")
SIZE = (760, 420)  # [px] of the page: enough for the panel beside the scene
PICTURE = (90, 120)  # [px] height and width of the scene's


def example(name: str) -> Mechanism:
    if name == "ur5":
        return balanced().mechanism
    return eq.load(FOLDER / f"{name}.yaml")


def free_port() -> int:
    """One of the system's choice: at a port that another viewer has just left, its page might still call."""
    with socket.socket() as found:
        found.bind(("127.0.0.1", 0))
        return found.getsockname()[1]


@contextmanager
def viewed(browser: Any, mechanism: Mechanism, output: Path) -> Iterator[tuple[Any, Any, list[str]]]:
    """A viewer, its page once it is drawn, and the addresses that the page asked for."""
    peer("viser")
    from equipoise.viewer.server import Viewer

    viewer = Viewer(mechanism, output, port=free_port())
    try:
        with opened(browser, *SIZE) as page:
            asked: list[str] = []
            page.on("request", lambda request: asked.append(request.url))
            page.on("websocket", lambda socket: asked.append(socket.url))
            page.goto(viewer.url)
            page.wait_for_selector("[data-residual]")
            yield viewer, page, asked
    finally:
        viewer.close()


def picture(viewer: Any) -> np.ndarray:
    """(height, width, 4) what the page draws once everything that it was sent is in place; 0 where nothing is."""
    # the gate hears no pictures, for nothing in the product asks for one
    messages.SHAPES["GetRenderResponseMessage"] = {"payload": bytes, "render_uuid": str}  # type: ignore[index]
    client = list(viewer.server.get_clients().values())[-1]  # a busy page may have to connect twice
    return client.get_render(*PICTURE, transport_format="png", timeout=PATIENCE / 1000).astype(int)


def field(page: Any, label: str) -> Any:
    """The number beside a slider."""
    row = page.locator(f"xpath=//label[normalize-space()='{label}']/../../..")
    return row.locator("input[type=text]").first


def put(page: Any, label: str, value: float) -> None:
    entry = field(page, label)
    entry.fill(f"{value:g}")
    entry.press("Tab")


def residual(page: Any) -> float:
    return float(page.locator("[data-residual]").get_attribute("data-residual"))


def placed(viewer: Any) -> np.ndarray:
    """(bodies, 7) where the scene has them."""
    return np.array([[*frame.position, *frame.wxyz] for frame in viewer.scene.bodies])


def reachable(model: Any, j: int, degrees: float) -> bool:
    """Whether a coordinate can be there while the others stay."""
    q = model.q.copy()
    q[j] = np.deg2rad(degrees)
    return bool(inside(model.tree, q[None])[0])


@pytest.mark.parametrize("name", EXAMPLES)
def test_what_a_user_touches(browser: Any, name: str, tmp_path: Path) -> None:
    m = example(name)
    output = tmp_path / "mine.yaml"
    with viewed(browser, m, output) as (viewer, page, asked):
        model = viewer.model
        before = picture(viewer)
        assert before.any()

        # a slider moves the arm and the plots
        j = int(np.argmax(np.abs(model.state.gravity_torque[0])))
        label = f"{model.tree.coordinates[j]} [deg]"
        q, torques, energies = (
            model.q.copy(), *(page.locator(f"[data-plot={plot}]").inner_html() for plot in ("torque", "energy")),
        )  # fmt: skip
        places = placed(viewer)
        aim = float(field(page, label).input_value())
        aim += next(way for way in (-12.0, 12.0) if reachable(model, j, aim + way))
        put(page, label, aim)
        wait_until(page, lambda: abs(model.q[j] - np.deg2rad(aim)) < 2e-3)
        wait_until(page, lambda: page.locator("[data-plot=energy]").inner_html() != energies)
        wait_until(page, lambda: page.locator("[data-plot=torque]").inner_html() != torques)
        assert np.abs(placed(viewer) - places).max() > 1e-3
        assert np.abs(model.q - q).max() > 0.1
        assert (picture(viewer) != before).any()

        # a spoilt spring is made good again
        assert residual(page) < 1e-9 * model.residual().unbalanced
        stiffness = model.springs[0].stiffness
        put(page, "stiffness [N/m]", 0.6 * stiffness)
        wait_until(page, lambda: residual(page) > 1e-6)
        assert model.springs[0].stiffness == pytest.approx(0.6 * stiffness, rel=0.01)
        spoilt = residual(page)
        page.get_by_role("button", name="Re-optimise").click()
        wait_until(page, lambda: residual(page) < spoilt)

        # what is saved is what is shown
        shown = residual(page)
        page.get_by_role("button", name="Save to mine.yaml").click()
        wait_until(page, output.exists)
        saved = eq.load(output)
        assert [s.name for s in saved.springs] == [s.name for s in model.mechanism.springs]
        from equipoise.viewer.model import Model

        assert Model(saved).residual().rms == pytest.approx(shown, rel=1e-6, abs=1e-9)
    hosts = {urlsplit(address).hostname or urlsplit(urlsplit(address).path).hostname for address in asked}
    assert hosts == {"127.0.0.1"}
    assert any(address.startswith("ws:") for address in asked)


def test_buttons_and_switches(browser: Any, tmp_path: Path) -> None:
    """Springs off and on, payload, the worst pose, the verdict, and a motion of a paper that plays."""
    with viewed(browser, example("lin2010_balanced"), tmp_path / "mine.yaml") as (viewer, page, _):
        model = viewer.model
        unbalanced = float(page.locator("[data-residual]").get_attribute("data-unbalanced"))
        switch = page.locator("xpath=//label[normalize-space()='springs on']/../../..").locator("input[type=checkbox]")
        switch.click(force=True)
        wait_until(page, lambda: residual(page) == pytest.approx(unbalanced, rel=1e-6))
        switch.click(force=True)
        wait_until(page, lambda: residual(page) < 1e-9 * unbalanced)
        put(page, "payload [kg]", 2.0)
        wait_until(page, lambda: residual(page) > 0.01)
        assert model.mechanism.masses[-1].mass == pytest.approx(2.0, abs=0.1)
        page.get_by_role("button", name="Worst pose").click()
        wait_until(page, lambda: model.judged is not None and np.allclose(model.q, model.judged.worst_configuration))
        put(page, "payload [kg]", 0.0)
        wait_until(page, lambda: residual(page) < 1e-9 * unbalanced)
        page.get_by_role("button", name=re.compile("Judge")).click()
        page.wait_for_selector("[data-verdict=exact]")
        assert "lin2010" in viewer.panel.motions
        viewer.panel.motion.value = "lin2010"
        start = model.q.copy()
        page.get_by_role("button", name="Play", exact=True).click()
        wait_until(page, lambda: np.abs(model.q - start).max() > 0.2)
        page.get_by_role("button", name="Stop", exact=True).click()
        wait_until(page, lambda: not viewer.panel.playing)


def test_space_of_links_is_drawn(browser: Any, tmp_path: Path) -> None:
    from equipoise.model.mechanism import Capsule

    m = eq.load(FOLDER / "pendulum.yaml")
    m = replace(m, capsules=(Capsule("rod", "arm", (0.0, 0.0, 0.0), (0.4, 0.0, 0.0), 0.05),))
    with viewed(browser, m, tmp_path / "mine.yaml") as (viewer, _, _):
        assert "/arm/1/capsule0" in viewer.server.scene._handle_from_node_name
        shown = picture(viewer)
        viewer.server.scene._handle_from_node_name["/arm/1/capsule0"].visible = False
        assert (picture(viewer) != shown).any()
