"""The verifier: alone in what it imports, and not to be deceived."""

from __future__ import annotations

import ast
import json
import sys
from pathlib import Path

import pytest
from campaign import campaign
from certified import EXACT, certificate, document
from tampered import holds, tampered

import equipoise as eq
from equipoise.proof import verify
from equipoise.proof.certificate import Refused

ALONE = Path(eq.__file__).parent / "proof" / "verify.py"
TARGETS = ("bounded", "mixed", "lee2014_table5a", "lenzo_layout_b", "pendulum", "four_bar")


def accepted(found: object) -> bool:
    try:
        eq.verify(found)  # type: ignore[arg-type]
    except Refused:
        return False
    return True


def test_it_imports_the_standard_library_only():
    tree = ast.parse(ALONE.read_text(encoding="utf-8"))
    names = [alias.name for node in ast.walk(tree) if isinstance(node, ast.Import) for alias in node.names]
    relative = [node for node in ast.walk(tree) if isinstance(node, ast.ImportFrom) and node.level]
    names += [str(node.module) for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)]
    assert not relative
    assert {*names} <= sys.stdlib_module_names


@campaign(1600, block=25)
def test_what_is_tampered_with_is_refused(seeds):
    """Where the other evaluation says that a claim does not follow any more, 1,000 times; else it is accepted."""
    false = 0
    for seed in seeds:
        found, what = tampered(document(TARGETS[seed % len(TARGETS)]), seed)
        expected = holds(found)
        assert accepted(found) == expected, (seed, what)
        false += not expected
    assert false > len(seeds) / 2


@pytest.mark.parametrize("name", ["bounded", "mixed", "lee2014_table5a", "four_bar"])
def test_the_other_evaluation_accepts_what_is_not_tampered_with(name):
    assert holds(document(name))


@pytest.mark.parametrize("name", EXACT[:3])
def test_claims_have_no_slack(name):
    """A claim that is stronger by a millionth is refused, joint by joint."""
    for joint, most in document(name)["claims"]["torque"]["at_most"].items():
        if float(most) > 1e-39:
            found = document(name)
            found["claims"]["torque"]["at_most"][joint] = repr(float(most) * (1 - 1e-6))
            assert not accepted(found)


@pytest.mark.parametrize("text", ["[]", "{}", "null", '{"format": "equipoise certificate 1", "claims": {"x": 1}}'])
def test_what_is_no_certificate_is_refused(text, tmp_path):
    path = tmp_path / "cert.json"
    path.write_text(text)
    assert not accepted(path)


@pytest.mark.parametrize("stiffness", ["1e12", "1e30"])
def test_a_bound_for_stiffer_springs_is_refused(stiffness):
    """What the shift costs is then more than the trial gives, and its square is large."""
    found = document("bounded")
    found["claims"]["bound"]["stiffness"] = stiffness
    assert not accepted(found)


def test_a_product_is_within_its_radius_at_every_corner():
    one, two = (
        (verify.UNIT, -verify.UNIT // 3, verify.UNIT // 50),
        (2 * verify.UNIT, verify.UNIT // 7, verify.UNIT // 90),
    )

    def corners(a, b, r):
        return [complex(a + x, b + y) / verify.UNIT for x in (-r, r) for y in (-r, r)]

    for p, q in ((one, two), (two, one)):
        ((a, b, r),) = (verify.Sum({(0,): p}) * verify.Sum({(0,): q})).values()
        for x in corners(*p):
            for y in corners(*q):
                off = x * y - complex(a, b) / verify.UNIT
                assert max(abs(off.real), abs(off.imag)) <= r / verify.UNIT * (1 + 1e-12)


def test_numbers_are_plain():
    """No exponent that takes forever, nothing but digits."""
    for bad in ("1e99999", "0x10", "1_000", " 1", "nan", "1/0", 1.0, None):
        found = json.loads(certificate("pendulum"))
        found["mechanism"]["gravity"][2] = bad
        assert not accepted(found)
