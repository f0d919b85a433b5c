"""The DXF of attachment points, read back by ezdxf."""

from __future__ import annotations

import io
from pathlib import Path

import ezdxf.filemanagement
import numpy as np
import pytest
from robots import lee_chen, lee_chen_springs
from zoo import pendulum

import equipoise as eq
from equipoise.kinematics import Tree
from equipoise.model.errors import InputError
from equipoise.report import attachments
from equipoise.report.attachments import LAYERS, to_text
from equipoise.report.poses import choose
from equipoise.report.skeleton import Skeleton

EXAMPLES = sorted((Path(__file__).parents[1] / "examples" / "mechanisms").glob("*.yaml"))
SPRUNG = [path for path in EXAMPLES if eq.load(path).springs]


def read(mechanism: eq.Mechanism):
    return ezdxf.filemanagement.read(io.StringIO(to_text(mechanism)))


def points(document) -> np.ndarray:
    """(ends, 3) [mm]"""
    return np.array([tuple(one.dxf.location) for one in document.modelspace().query("POINT[layer=='ATTACHMENTS']")])


def test_the_pendulum_at_rest():
    document = read(pendulum())
    assert document.units == 4  # mm
    assert points(document) == pytest.approx(np.array([[0, 200, 0], [150, 0, 0]]))  # straight on: x-z becomes x-y
    (link,) = document.modelspace().query("LINE[layer=='LINKS']")
    assert tuple(link.dxf.end) == pytest.approx((300, 0, 0))
    said = [one.dxf.text for one in document.modelspace().query("TEXT")]
    name = pendulum().springs[0].name
    assert said == [f"k1 = 196.2 N/m, {name}", "a1 world (0, 0, 200)", "b1 arm (150, 0, 0)"]


@pytest.mark.parametrize("path", SPRUNG, ids=lambda path: path.stem)
def test_every_example_is_sound_and_to_scale(path):
    mechanism = eq.load(path)
    document = read(mechanism)
    assert not document.audit().errors
    assert set(LAYERS) <= {layer.dxf.name for layer in document.layers}
    tree, skeleton = Tree.of(mechanism), Skeleton.of(mechanism)
    (view, _), ends = choose(mechanism, skeleton), 1000 * skeleton.ends(tree.poses(tree.rest[None]))[0]
    across = ends[:, 0] - ends[:, 1]
    drawn = points(document).reshape(-1, 2, 3)
    wanted = view.flat(across) if view.planar else across
    assert np.linalg.norm(drawn[:, 0] - drawn[:, 1], axis=1) == pytest.approx(np.linalg.norm(wanted, axis=1))


def test_names_of_any_script_survive():
    spring = eq.Spring("пружина %%c 机", "world", (0, 0, 0.2), "arm", (0.15, 0, 0), 196.2)
    said = [one.dxf.text for one in read(pendulum().with_springs([spring])).modelspace().query("TEXT")]
    assert said[0] == "k1 = 196.2 N/m, пружина %%c 机"


def test_springs_of_no_size_are_drawn():
    spring = eq.Spring("s", "world", (0, 0, 0), "dot", (0, 0, 0), 100.0)
    joint = eq.Joint("j", "revolute", "world", "dot", axis=(0, -1, 0))
    dot = eq.Mechanism("dot", (eq.Body("dot"),), (joint,), springs=(spring,))
    assert not read(dot).audit().errors


def test_without_springs_it_says_so():
    with pytest.raises(InputError, match="has no springs, so nothing is attached"):
        to_text(lee_chen())


def test_without_ezdxf_it_says_what_to_install(monkeypatch):
    monkeypatch.setattr(attachments, "find_spec", lambda name: None)
    with pytest.raises(InputError, match=r"pip install 'equipoise\[cad\]'"):
        to_text(pendulum())


def test_export_writes_it_whole_or_not_at_all(run, tmp_path):
    source, out = tmp_path / "arm.yaml", tmp_path / "arm.dxf"
    eq.save(lee_chen(), source)
    code, said, err = run("export", source, "--to", "dxf", "-o", out)
    assert (code, said) == (2, "")
    assert "no springs" in err
    assert not out.exists()
    eq.save(lee_chen_springs(), source)
    assert run("export", source, "--to", "dxf", "-o", out)[0] == 0
    assert len(points(ezdxf.filemanagement.readfile(out))) == 6
