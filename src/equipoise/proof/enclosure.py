"""The energy of a written mechanism as a finite sum whose coefficients are enclosed, in ball arithmetic (python-flint).

Relative rotations R_XY are multiplied out along the tree, and vectors are sums ``sum_X R_X v_X``, so that a scalar
product is ``sum_XY v_X' R_XY w_Y`` (as in `energy/fourier/frames`, there in double precision).
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from fractions import Fraction
from math import lcm
from typing import Any

from ..model.errors import InputError, NoFourierForm

BITS = 480
MOST = 20_000  # terms of one relative rotation
Key = tuple[int, ...]
Terms = dict[Key, Any]
"""(frequencies, degrees) -> a matrix of balls. Frequencies are in units of 1/`Enclosure.unit`."""


def flint() -> Any:
    """The library.

    Raises:
        InputError: it is not installed.
    """
    try:
        import flint as found
    except ImportError:
        raise InputError("certificates need python-flint: pip install 'equipoise[proof]'") from None
    found.ctx.prec = BITS
    return found


class Enclosure:
    """Of the mechanism that `statement.written` gives.

    Attributes:
        unit: of the frequencies.
        energy: gravity and springs, their masses included; (frequencies, degrees) -> [J, or J/m^degree].
        load: the same without springs.
    """

    def __init__(self, data: Mapping[str, Any]) -> None:
        self.flint, self.data, self.names = flint(), data, data["coordinates"]
        motions = [m for joint in data["joints"] for m in (*joint["turns"], *joint["slides"])]
        ratios = [Fraction(x) for m in (*motions, *data["springs"]) for x in m.get("by", {}).values()]
        self.unit = lcm(*(ratio.denominator for ratio in ratios))
        self.zero: Key = (0,) * (2 * len(self.names))
        self._joints = {joint["child"]: joint for joint in data["joints"]}
        self._rotations: dict[tuple[str, str], Terms] = {}
        self._turns = {body: self._turn(joint) for body, joint in self._joints.items()}

    @property
    def powers(self) -> list[str]:
        """The coordinates of which the energy has powers: they slide, or a spring on a joint acts on them."""
        motions = [*(slide for joint in self.data["joints"] for slide in joint["slides"]), *self.data["springs"]]
        return [name for name in self.names if any(name in motion.get("by", ()) for motion in motions)]

    def load(self) -> dict[Key, Any]:
        """Gravity without springs: (frequencies, degrees) -> [J, or J/m^degree], without what is constant."""
        return self._scalar(self._weight(self.data["masses"]))

    def energy(self) -> dict[Key, Any]:
        """Gravity and springs, their masses included."""
        parts = [self._weight([*self.data["masses"], *self.data["spring_masses"]])]
        return self._scalar(_sum([*parts, *map(self._elastic, self.data["springs"])]))

    def torque(self, within: Mapping[str, Fraction]) -> list[Fraction]:
        """For each coordinate what its torque is at most, while those that slide are within +-`within` [m or rad]."""
        n, bound = len(self.names), [Fraction(0)] * len(self.names)
        reach = [within.get(name, Fraction(1)) for name in self.names]
        for key, c in self.energy().items():
            size, degrees = _upper(abs(c)), key[n:]
            for j, k in enumerate(key[:n]):
                lower = [d - (i == j) for i, d in enumerate(degrees)]
                bound[j] += size * Fraction(abs(k), self.unit) * _powers(reach, degrees)
                bound[j] += size * degrees[j] * _powers(reach, lower) if degrees[j] else 0
        return bound

    def varies(self, terms: Mapping[Key, Any], within: Mapping[str, Fraction]) -> Fraction:
        """How far a sum is from a constant at most."""
        reach, n = [within.get(name, Fraction(1)) for name in self.names], len(self.names)
        parts = (_upper(abs(c)) * _powers(reach, key[n:]) for key, c in terms.items() if any(key))
        return sum(parts, Fraction(0))

    def gap(self, ends: Mapping[str, Any], body: str) -> list[dict[Key, Any]]:
        """From a point of one body to one of another, its three components in the frame of a body [m]."""
        parts: dict[str, list[Terms]] = {}
        for end, sign in (("a", -1), ("b", 1)):
            own = ends[f"body_{end}"]
            parts.setdefault(own, []).append({self.zero: self._column(ends[f"p_{end}"], Fraction(sign))})
            for X, step in self._origin(own):
                parts.setdefault(X, []).append({key: c * self._exact(sign) for key, c in step.items()})
        each = [_product(self._relative(body, X), summed) for X, own in parts.items() if (summed := _sum(own))]
        total = _sum(each)
        return [{key: c[i, 0] for key, c in total.items()} for i in range(3)]

    def form(self, body_a: str, body_b: str, lift: Sequence[Sequence[float]]) -> Terms:
        """Half the square of the stretch of a spring between two bodies, (7, 7) in y: its ends are ``lift @ y``."""
        matrix, exact = self.flint.acb_mat, self._exact
        L = matrix([[exact(x) for x in row] for row in lift])
        ends = {body_a: (-1, 0), body_b: (1, 4)}
        parts: dict[str, list[Terms]] = {}
        for body, (sign, first) in ends.items():
            own = matrix([[exact(sign * (first + i == j)) for j in range(7)] for i in range(3)])
            parts.setdefault(body, []).append({self.zero: own * L})
            one = matrix([[exact(j == 3) for j in range(7)]]) * L
            for X, step in self._origin(body):
                parts.setdefault(X, []).append({k: (c * exact(sign)) * one for k, c in step.items()})
        return self._half_square({X: _sum(own) for X, own in parts.items()})

    def number(self, a: Any, b: Any = 0) -> Any:
        """``a + ib`` of rational numbers or texts of them."""
        return self._exact(Fraction(a)) + self._exact(Fraction(b)) * self.flint.acb(0, 1)

    def lower(self, x: Any) -> Fraction:
        """What a real number is at least."""
        exact = x.lower().fmpq()
        return Fraction(int(exact.p), int(exact.q))

    def _exact(self, x: float | Fraction) -> Any:
        x = Fraction(x)
        return self.flint.acb(self.flint.fmpq(x.numerator, x.denominator))

    def _column(self, v: Iterable[Any], factor: Fraction = Fraction(1)) -> Any:
        return self.flint.acb_mat([[self._exact(Fraction(x) * factor)] for x in v])

    def _scalar(self, terms: Terms) -> dict[Key, Any]:
        return {key: c[0, 0] for key, c in terms.items() if any(key)}

    def _value(self, motion: Mapping[str, Any]) -> Terms:
        """1 x 1, of degree one."""
        n, matrix = len(self.names), self.flint.acb_mat
        found = {self.zero: matrix([[self._exact(Fraction(motion["from"]))]])}
        for name, ratio in motion["by"].items():
            key = tuple(int(j == n + self.names.index(name)) for j in range(2 * n))
            found[key] = matrix([[self._exact(Fraction(ratio))]])
        return found

    def _frequency(self, motion: Mapping[str, Any], times: int = 1) -> Key:
        whole = [int(times * self.unit * Fraction(motion["by"].get(name, 0))) for name in self.names]
        return (*whole, *self.zero[len(self.names) :])

    def _turn(self, joint: Mapping[str, Any]) -> Terms:
        """The orientation of its child in its base."""
        acb, matrix = self.flint.acb, self.flint.acb_mat
        eye = matrix([[acb(int(i == j)) for j in range(3)] for i in range(3)])
        R: Terms = {self.zero: eye}
        for motion in joint["turns"]:
            a = self._unit(motion["axis"])
            across = matrix([[acb(0), -a[2, 0], a[1, 0]], [a[2, 0], acb(0), -a[0, 0]], [-a[1, 0], a[0, 0], acb(0)]])
            A0 = a * a.transpose()
            A1 = (eye - A0 - across * acb(0, 1)) * acb(0.5)
            phase, key = (self._exact(Fraction(motion["from"])) * acb(0, 1)).exp(), self._frequency(motion)
            back = tuple(-k for k in key)
            waves = [{self.zero: A0}, {key: A1 * phase}, {back: (A1 * phase).conjugate()}]
            R = _product(R, _sum(waves))
        return R

    def _unit(self, axis: Sequence[str]) -> Any:
        a = self._column(axis)
        squared = sum(Fraction(x) ** 2 for x in axis)
        return a * (self._exact(1) / self._exact(squared).sqrt())

    def _bases(self, body: str) -> list[str]:
        return [body, *(self._bases(self._joints[body]["base"]) if body in self._joints else ())]

    def _relative(self, X: str, Y: str) -> Terms:
        """R_XY."""
        if X == Y:
            return {self.zero: self._eye}
        if (X, Y) not in self._rotations:
            above = self._bases(Y)
            if X in above:
                base = self._joints[Y]["base"]
                found = _product(self._relative(X, base), self._turns[Y])
            elif Y in self._bases(X):
                found = _transposed(self._relative(Y, X))
            else:
                top = next(body for body in self._bases(X) if body in above)
                found = _product(self._relative(X, top), self._relative(top, Y))
            if len(found) > MOST:
                raise NoFourierForm(f"its Fourier form has more than {MOST:,} terms")
            self._rotations[X, Y] = found
        return self._rotations[X, Y]

    @property
    def _eye(self) -> Any:
        return self.flint.acb_mat([[self.flint.acb(int(i == j)) for j in range(3)] for i in range(3)])

    def _origin(self, body: str) -> Iterator[tuple[str, Terms]]:
        """The steps (X, 3 x 1 in the frame of X) whose sum is the body's origin."""
        while body in self._joints:
            joint = self._joints[body]
            step = [{self.zero: self._column(joint["xyz"])}]
            for slide in joint["slides"]:
                along = _product(self._turns[body], {self.zero: self._unit(slide["axis"])})
                step.append(_product(along, self._value(slide)))
            body = joint["parent"]
            yield body, _sum(step)

    def _weight(self, masses: Iterable[Mapping[str, Any]]) -> Terms:
        parts: dict[str, list[Terms]] = {}
        for one in masses:
            m = Fraction(one["mass"])
            parts.setdefault(one["body"], []).append({self.zero: self._column(one["position"], m)})
            for X, step in self._origin(one["body"]):
                parts.setdefault(X, []).append({key: c * self._exact(m) for key, c in step.items()})
        g = {self.zero: self._column(self.data["gravity"], Fraction(-1)).transpose()}
        return _sum([_product(g, _product(self._relative("world", X), _sum(own))) for X, own in parts.items()])

    def _elastic(self, one: Mapping[str, Any]) -> Terms:
        if "by" not in one:
            z = [*one["p_a"], 1, *one["p_b"]]
            lift = [[Fraction(x)] for x in z]
            form = self.form(one["body_a"], one["body_b"], lift)  # type: ignore[arg-type]
            return {key: c * self._exact(Fraction(one["stiffness"])) for key, c in form.items()}
        s, (c1, c2) = self._value(one), map(Fraction, one["powers"])
        parts = [{key: c * self._exact(c1) for key, c in s.items()}]
        parts.append({key: c * self._exact(c2) for key, c in _product(s, s).items()})
        for times, (a, b) in enumerate(one["waves"], 1):
            phase = (self._exact(times * Fraction(one["from"])) * self.flint.acb(0, 1)).exp()
            half = (self._exact(Fraction(a)) - self._exact(Fraction(b)) * self.flint.acb(0, 1)) * phase / 2
            key = self._frequency(one, times)
            both = ((key, half), (tuple(-k for k in key), half.conjugate()))
            parts += [{key: self.flint.acb_mat([[c]])} for key, c in both]
        return _sum(parts)

    def _half_square(self, V: Mapping[str, Terms]) -> Terms:
        parts, half, bodies = [], self._exact(Fraction(1, 2)), [*V]
        for i, X in enumerate(bodies):
            left = _transposed(V[X])
            parts.append({key: c * half for key, c in _product(left, V[X]).items()})
            for Y in bodies[:i]:
                cross = _product(_product(left, self._relative(X, Y)), V[Y])
                parts.append({key: (c + c.transpose()) * half for key, c in cross.items()})
        return _sum(parts)


def _sum(parts: Sequence[Terms]) -> Terms:
    total: Terms = {}
    for part in parts:
        for key, c in part.items():
            total[key] = total[key] + c if key in total else c
    return {key: c for key, c in total.items() if not all(x.real.is_zero() and x.imag.is_zero() for x in c.entries())}


def _product(one: Terms, other: Terms) -> Terms:
    total: Terms = {}
    for k, c in one.items():
        for m, d in other.items():
            key = tuple(map(int.__add__, k, m))
            total[key] = total[key] + c * d if key in total else c * d
    return total


def _transposed(one: Terms) -> Terms:
    return {key: c.transpose() for key, c in one.items()}


def _powers(reach: Sequence[Fraction], degrees: Sequence[int]) -> Fraction:
    total = Fraction(1)
    for x, degree in zip(reach, degrees, strict=True):
        total *= x**degree
    return total


def _upper(x: Any) -> Fraction:
    exact = x.upper().fmpq()
    return Fraction(int(exact.p), int(exact.q))
