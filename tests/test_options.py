"""Each method's options are one type: signatures, the front door, ``--set`` and text with units follow from it."""

from dataclasses import FrozenInstanceError, fields
from inspect import signature

import pytest
from robots import lee_chen, planar_arm

import equipoise as eq
from equipoise.model.errors import InputError
from equipoise.synthesis import METHODS, by_name
from equipoise.synthesis.convex.method import ConvexOptions, SolverOptions
from equipoise.synthesis.problem import ProblemOptions
from equipoise.synthesis.pseudobase.method import PseudobaseOptions


@pytest.mark.parametrize("method", METHODS.values(), ids=METHODS)
def test_signature_and_parameters_are_the_fields(method):
    _, *arguments = signature(method.run).parameters.values()
    assert [a.name for a in arguments] == [f.name for f in fields(method.options)]
    assert all(a.kind is a.KEYWORD_ONLY and a.default is not a.empty for a in arguments)
    assert {a.name: a.default for a in arguments} == {f.name: f.default for f in fields(method.options)}
    assert method.parameters.keys() <= {a.name for a in arguments}
    assert all(parameter.help for parameter in method.parameters.values())


def test_options_are_values():
    first, second = PseudobaseOptions(auxiliary=0.05), PseudobaseOptions(auxiliary="5%")
    assert first == second
    with pytest.raises(FrozenInstanceError):
        first.height = 1.0  # type: ignore[misc]
    assert set(ConvexOptions.names()) == {*ProblemOptions.names(), *SolverOptions.names()}


def test_quantities_may_be_text():
    options = PseudobaseOptions(
        stiffness={"arm": "2 kN/m", "*": 300}, centre={"arm": ["10 mm", 0, "1e-1"]}, height="25 cm", planar=("arm",)
    )
    assert options.stiffness == {"arm": pytest.approx(2000.0), "*": 300}
    assert options.centre == {"arm": [pytest.approx(0.01), 0, 0.1]}
    assert options.height == pytest.approx(0.25)
    assert options.planar == ("arm",)
    metres, text = (eq.design(lee_chen(), span=3, radius=radius, springs=3) for radius in (0.2, "200 mm"))
    assert metres.mechanism == text.mechanism
    by_text = eq.design(planar_arm([1], [0.4], [0.2]), method="pseudobase", auxiliary="5%", height="100 mm")
    assert by_text.free_parameters == eq.design(
        planar_arm([1], [0.4], [0.2]), method="pseudobase", auxiliary=0.05, height=0.1
    ).free_parameters  # fmt: skip


@pytest.mark.parametrize(
    ("method", "options", "message"),
    [
        ("convex", {"radius": "3 kg"}, "radius: expected a number"),
        ("convex", {"spam": 2}, r"spam: method 'convex' has no such option \(valid: span, pairs"),
        ("convex", {"auxiliary": 2}, "auxiliary: method 'convex' has no such option"),
        ("planar", {"stiffness": {"13": "20 mm"}}, "stiffness.13: expected a number"),
        ("pseudobase", {"auxiliary": "some"}, "auxiliary: expected a share such as 0.02 or 2%, found 'some'"),
        ("pseudobase", {"span": 2}, "span: method 'pseudobase' has no such option"),
        ("pseudobse", {}, "no method 'pseudobse'; did you mean 'pseudobase'"),
    ],
)
def test_refusals(method, options, message):
    with pytest.raises(InputError, match=message):
        by_name(lee_chen(), method, **options)


def test_progress_is_an_option_of_every_method():
    heard = []
    eq.design(lee_chen(), "planar", progress=lambda what, done: heard.append((what, done)))
    assert heard
    eq.design(lee_chen(), "pseudobase", progress=lambda what, done: heard.append((what, done)))  # quick: says nothing
