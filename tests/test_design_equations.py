"""Design equations in symbols: the paper's, by a computer algebra system, and the numbers of `blocks`."""

from cmath import exp, phase

import numpy as np
import pytest
import sympy
from robots import lee_chen

from equipoise.synthesis.planar.arm import Installation, PlanarArm
from equipoise.synthesis.planar.design_equations import Angles, SymbolicBlocks, Term, design_equations
from equipoise.synthesis.planar.stiffness_blocks import StiffnessBlocks

UP, AHEAD, BACK = 1, 0, 2  # angles in quarter turns
MIN_SPRINGS = design_equations(
    4, [(1, 3, "13", Angles(UP, BACK)), (1, 4, "14_1", Angles(UP, AHEAD)), (1, 4, "14_2", Angles(UP, BACK))]
)
MIN_SPAN = design_equations(
    4,
    [
        (1, 2, "12", Angles(UP, AHEAD)),
        (1, 4, "14", Angles(UP, AHEAD)),
        (2, 4, "24", Angles(AHEAD, AHEAD)),
        (3, 4, "34", Angles(BACK, BACK)),
    ],
)
# The factors of I and I' as printed; Eq. (43) stands for K_24 and K_34
PAPER_39_TO_43 = {
    (1, 2): "I*(-(s2/r2*m2 + m3 + m4)*g + k13*a13 + k14_1*a14_1 + k14_2*a14_2)",
    (1, 3): "I*(-(s3/r3*m3 + m4)*g - k13*a13*b13/r3 + k14_1*a14_1 + k14_2*a14_2)",
    (1, 4): "I*(-(s4/r4*m4)*g + k14_1*a14_1*b14_1/r4 - k14_2*a14_2*b14_2/r4)",
    (2, 3): "-k13*b13/r3 + k14_1 + k14_2",
    (2, 4): "k14_1*b14_1/r4 - k14_2*b14_2/r4",
    (3, 4): "k14_1*b14_1/r4 - k14_2*b14_2/r4",
}
PAPER_49_TO_54 = {
    (1, 2): "I*(-(s2/r2*m2 + m3 + m4)*g + k12*a12*b12/r2 + k14*a14)",
    (1, 3): "I*(-(s3/r3*m3 + m4)*g + k14*a14)",
    (1, 4): "I*(-(s4/r4*m4)*g + k14*a14*b14/r4)",
    (2, 3): "k14 - k24*a24/r2",
    (2, 4): "k14*b14/r4 - k24*a24*b24/(r2*r4)",
    (3, 4): "k14*b14/r4 + k24*b24/r4 - k34*a34*b34/(r3*r4)",
}


def algebra(terms: tuple[Term, ...]) -> sympy.Expr:
    """The sum as a complex number, I' being the imaginary unit; built from the data, not from the text."""
    total = sympy.Integer(0)
    for term in terms:
        above, below = (sympy.prod(map(sympy.Symbol, names)) for names in (term.above, term.below))
        angle = sum((sign * sympy.Symbol(name) for sign, name in term.turn), term.quarters * sympy.pi / 2)
        total += term.sign * above / below * sympy.exp(sympy.I * angle)
    return total


def put(expression: sympy.Expr, values: dict[str, float]) -> complex:
    return complex(expression.subs({sympy.Symbol(name): value for name, value in values.items()}))


@pytest.mark.parametrize(("found", "paper"), [(MIN_SPRINGS, PAPER_39_TO_43), (MIN_SPAN, PAPER_49_TO_54)])
def test_the_design_equations_of_the_paper(found, paper):
    equations = found.equations()
    assert equations.keys() == paper.keys()
    for pair, terms in equations.items():
        assert sympy.simplify(algebra(terms) - sympy.sympify(paper[pair])) == 0, pair


def test_the_printed_text_says_the_same():
    """K_13 = [-s3 m3 g/r3 - ..] I' = 0, read back by the algebra system."""
    for line, (pair, terms) in zip(str(MIN_SPRINGS).splitlines(), MIN_SPRINGS.equations().items(), strict=True):
        name, expression, zero = line.split(" = ")
        assert (name, zero) == (f"K_{pair[0]}{pair[1]}", "0")
        factor, unit = expression.rsplit(" ", 1)
        read = sympy.sympify(factor.strip("[]").replace(" ", "*").replace("*+*", " + ").replace("*-*", " - "))
        assert sympy.simplify(algebra(terms) / (sympy.I if unit == "I'" else 1) - read) == 0, line


def test_angles_left_open_give_the_numbers_of_the_blocks():
    """Any angles and mass centres: Eqs. (7)-(8) and (18), with numbers put in."""
    rng = np.random.default_rng(0)
    arm = PlanarArm.of(lee_chen(), end=0.070)
    for i, k in [(1, 2), (1, 4), (2, 3), (2, 4)]:
        a, b = rng.uniform(0.1, 0.5, 2) * np.exp(1j * rng.uniform(-3, 3, 2))
        one = Installation(i, k, 120.0, complex(a), complex(b))
        values = {f"k{i}{k}": 120.0, f"a{i}{k}": abs(a), f"b{i}{k}": abs(b)}
        values |= {f"alpha{i}{k}": phase(a), f"beta{i}{k}": phase(b)}
        values |= {f"r{j}": arm.lengths[j - 1] for j in range(2, 5)}
        numbers = StiffnessBlocks.spring(arm, one)
        for (u, v), terms in SymbolicBlocks.spring(4, i, k, f"{i}{k}").blocks.items():
            assert put(algebra(terms), values) == pytest.approx(numbers.block(u, v)), (i, k, u, v)


def test_mass_centres_off_the_line():
    gravity = SymbolicBlocks.gravity(3, straight=False).equations()
    values = {"s2": 0.1, "r2": 0.2, "m2": 1.5, "m3": 0.7, "g": 9.81, "delta2": 0.3}
    expected = -9.81j * (0.1 / 0.2 * 1.5 * exp(0.3j) + 0.7)
    assert put(algebra(gravity[1, 2]), values) == pytest.approx(expected)


def test_text_and_latex():
    spring = SymbolicBlocks.spring(3, 1, 3, "13", Angles(UP, BACK))
    assert spring.matrix().splitlines() == [
        "[ k13 a13 a13 I ; k13 a13 I' ; -k13 a13 b13/r3 I' ]",
        "[ k13 I ; -k13 b13/r3 I ]",
        "[ k13 b13 b13/(r3 r3) I ]",
    ]
    assert r"& k^{13} \mathbf{I} & -\frac{k^{13} b^{13}}{r_{3}} \mathbf{I} \\" in spring.matrix_latex()
    opened = SymbolicBlocks.spring(3, 1, 3, "13").matrix()
    assert "-k13 a13 b13/r3 R(beta13 - alpha13)" in opened
    assert r"\mathbf{R}(\beta^{13} - \alpha^{13})" in SymbolicBlocks.spring(3, 1, 3, "13").matrix_latex()
    first = MIN_SPRINGS.latex().splitlines()[0]
    assert first.startswith(r"\mathbf{K}_{12} = [-\frac{s_{2} m_{2} g}{r_{2}} - m_{3} g - m_{4} g + k^{13} a^{13}")
    assert first.endswith(r"] \mathbf{I}' = \mathbf{0} \\")


def test_angles_of_an_installation():
    assert Angles.of(Installation(1, 3, 1.0, 0.1j, -0.2)) == Angles(UP, BACK)
    assert Angles.of(Installation(1, 3, 1.0, -0.1j, 0.1 + 0.1j)) == Angles(3, None)
