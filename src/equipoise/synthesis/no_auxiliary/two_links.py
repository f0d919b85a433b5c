"""Two links without auxiliary links: two or three springs, layouts a to d (Lenzo 2017, Sec. 3.2 and Fig. 5).

Spring k2 goes from a2 above the shoulder to b2 from the elbow on link 2, spring k12 from b12 from the shoulder on
link 1 to a12 from the elbow on link 2; spring k1, where there is one, from a1 above the shoulder to b1 on link 1. With
x0 up, x1 from shoulder to elbow and x2 along link 2,

    (m1 g h1 + m2 g l1 - k1 a1 b1 - k2 a2 l1) x1.x0 = 0
    (m2 g h2 - k2 a2 b2) x2.x0 = 0                                                                (14)
    (k2 b2 l1 + k12 a12 (l1 - b12)) x1.x2 = 0

and (15) is the same without spring k1. Here m1 h1 + m2 l1 and m2 h2 are the first moments of the links, with point
masses and everything beyond. With spring k1 the mass centre of link 1 may be anywhere: b1 is then along what the first
line leaves.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Literal

import numpy as np

from ...model.arrays import Array, frozen
from ...model.elements import Spring
from ...model.errors import InfeasibleError
from ..arms.chain import Chain, ChainLink
from ..products import Product, fill, show

LayoutName = Literal["a", "b", "c", "d"]
LAYOUTS: dict[str, tuple[int, int, int]] = {"b": (1, 1, 1), "a": (-1, -1, 1), "c": (1, -1, -1), "d": (-1, 1, -1)}
"""Signs of a12, b12 - l1 and b2; the paper's choice first, then those that extend fewer links."""
FREE = ("k2", "a2", "b2", "k12", "a12", "b12")
FREE_3 = ("k1", "a1", "b1")
PAST = "b12 - l1"  # how far spring k12 starts past the elbow
_SIGNED = ("a12", PAST, "b2")


@frozen
class TwoLinks:
    """The two loaded links of a chain, and how large attachments on them are by default.

    Attributes:
        x2: (3,) the direction of link 2 at q = 0: the line of its moment, on the side where the link is.
        size: of attachments on link 1 and link 2 [m].
    """

    chain: Chain
    x2: Array
    size: tuple[float, float]

    @property
    def link(self) -> tuple[ChainLink, ChainLink]:
        """Upper arm and forearm."""
        first, second = self.chain.loaded
        return first, second

    @property
    def l1(self) -> Array:
        """(3,) from shoulder to elbow [m]."""
        length = self.link[0].length
        assert length is not None  # there is a second link
        return length

    @property
    def S1(self) -> Array:
        """(3,) weight moment of link 1: m1 g h1 + m2 g l1 times x1 [N m]."""
        return self.chain.weight * self.link[0].moment

    @property
    def S2(self) -> float:
        """Weight moment of link 2 along x2: m2 g h2 [N m]."""
        return self.chain.weight * float(self.link[1].moment @ self.x2)

    @property
    def on_line(self) -> bool:
        """Whether the mass centre of link 1 is on the line from shoulder to elbow, as (15) needs."""
        return not self.link[0].off_line(self.chain.near)


def springs(
    arm: TwoLinks, layout: str | None, count: int | None, given: Mapping[str, float]
) -> tuple[tuple[Spring, ...], dict[str, object]]:
    """The springs, and the values of all parameters.

    Args:
        layout: None for the first of `LAYOUTS` that suits the values given.
        count: 2 or 3; None for as few as (14) and (15) allow.
        given: of `FREE`, and with three springs `FREE_3`.

    Raises:
        InfeasibleError: no such springs balance the arm; the message names the condition.
    """
    count = count or (2 if arm.on_line and not set(FREE_3) & set(given) else 3)
    l1 = float(np.linalg.norm(arm.l1))
    known = {name: given[name] for name in FREE if name in given}
    if "b12" in known:
        known[PAST] = known.pop("b12") - l1
        if abs(known[PAST]) <= arm.chain.near:
            raise InfeasibleError(
                f"b12 = l1 = {1e3 * l1:.6g} mm is the elbow itself: from there spring k12 does nothing"
            )
    lift = _lift(arm) if count == 2 else None
    a2 = _sign_of_a2(arm, lift, layout, known)
    layout = _layout(arm, layout, a2, known)
    values = fill(_products(arm, lift), known, _defaults(arm, layout, a2))
    values["b12"] = l1 + values.pop(PAST)
    left = arm.S1 - values["k2"] * values["a2"] * arm.l1  # what the first line of (14) leaves for spring k1
    if count == 3:
        values |= _spring_1(arm, left, {name: given[name] for name in FREE_3 if name in given})
    for name in ("k2", "k12", "k1"):
        if values.get(name, 1.0) <= 0:
            raise InfeasibleError(
                f"{show(name, values[name])} is not more than 0: change the sign of one of its lengths"
            )
    base, (upper, fore) = arm.chain.base, arm.link
    x1, up = arm.l1 / l1, arm.chain.up
    ends = {}  # points from the shoulder, at q = 0
    if count == 3:
        ends["k1"] = base, values["a1"] * up, upper.body, values["b1"] * _along(left, x1)
    ends |= {
        "k2": (base, values["a2"] * up, fore.body, arm.l1 + values["b2"] * arm.x2),
        "k12": (upper.body, values["b12"] * x1, fore.body, arm.l1 + values["a12"] * arm.x2),
    }
    made = tuple(
        Spring(name, A, arm.chain.on(A, upper.centre + p), B, arm.chain.on(B, upper.centre + q), values[name])
        for name, (A, p, B, q) in ends.items()
    )
    order = (*FREE_3, *FREE)
    return made, {"layout": layout, "springs": count, **{name: values[name] for name in order if name in values}}


def _lift(arm: TwoLinks) -> float:
    """k2 a2 [N], which the first line of (15) fixes."""
    link, near = arm.link[0], arm.chain.near
    if not arm.on_line:
        off = 1e3 * float(np.linalg.norm(link.across)) / link.mass
        raise InfeasibleError(
            f"two springs need the mass centre of '{link.body}' on the line from shoulder to elbow (15), and it is "
            f"{off:.4g} mm off: springs=3 allows for it, or layout=ground"
        )
    if abs(link.along) * float(np.linalg.norm(arm.l1)) <= near * link.mass:
        raise InfeasibleError(
            f"the moment of '{link.body}' is zero, so that k2 a2 = 0 (15), and nothing is left to balance "
            f"'{arm.link[1].body}': springs=3 does it, or layout=ground"
        )
    return arm.chain.weight * link.along


def _sign_of_a2(arm: TwoLinks, lift: float | None, layout: str | None, known: Mapping[str, float]) -> int:
    """Which side of the shoulder spring k2 starts: above (1) or below (-1)."""
    if lift is not None:
        sign = _sign(lift)
        if "a2" in known and _sign(known["a2"]) != sign:
            side, why = ("> 0", "pulls the arm down") if sign > 0 else ("< 0", "pulls the arm up, as its masses do")
            where = "below" if sign > 0 else "above"
            raise InfeasibleError(
                f"a2 {side} is needed, found {1e3 * known['a2']:.6g} mm: k2 a2 = m1 g h1 / l1 + m2 g = {lift:.6g} N "
                f"(15) and k2 > 0; a spring from {where} the shoulder {why}"
            )
        return sign
    if "a2" in known:
        return _sign(known["a2"])
    b2 = known.get("b2", LAYOUTS[layout][2] if layout else arm.S2)
    return _sign(b2) * _sign(arm.S2)


def _layout(arm: TwoLinks, asked: str | None, a2: int, known: Mapping[str, float]) -> str:
    """The layout asked for, or the first that suits the signs of the values given; `a2` is a sign."""
    b2 = a2 * _sign(arm.S2)  # second line of (14) and (15), k2 being positive
    why = f"with a2 {_than(a2)} 0, k2 a2 b2 = m2 g h2 = {arm.S2:.6g} N m (14) gives b2 {_than(b2)} 0"
    fit = [name for name, sign in LAYOUTS.items() if sign[2] == b2]
    if asked is not None and asked not in fit:
        raise InfeasibleError(
            f"layout {asked} needs h2 {_than(-_sign(arm.S2))} 0, for it has b2 {_than(-b2)} 0: {why}; layouts "
            f"{' and '.join(sorted(fit))} suit it"
        )
    for name in fit if asked is None else [asked]:
        wrong = [x for x, sign in zip(_SIGNED, LAYOUTS[name], strict=True) if _sign(known.get(x, sign)) != sign]
        if not wrong:
            return name
    l1 = float(np.linalg.norm(arm.l1))
    found = ", ".join(show(x, known[x]) for x in _SIGNED if x in known)
    allowed = " or ".join(f"layout {name} ({_conditions(name, l1)})" for name in (fit if asked is None else [asked]))
    raise InfeasibleError(f"{found}: the signs are not those of {allowed}; {why}")


def _conditions(layout: str, l1: float) -> str:
    a12, d, b2 = (_than(sign) for sign in LAYOUTS[layout])
    return f"a12 {a12} 0, b12 {d} l1 = {1e3 * l1:.6g} mm, b2 {b2} 0"


def _products(arm: TwoLinks, lift: float | None) -> list[Product]:
    """(14) or, where `lift` is k2 a2 [N], (15)."""
    l1 = float(np.linalg.norm(arm.l1))
    S2 = arm.S2
    elbow = Product("k12 a12 (b12 - l1) / (k2 b2) = l1", l1, "m", ("k12", "a12", PAST), ("k2", "b2"))
    if lift is not None:
        b2 = Product("b2 = m2 g h2 / (k2 a2)", S2 / lift, "m", ("b2",))
        return [b2, Product("k2 a2 = m1 g h1 / l1 + m2 g", lift, "N", ("k2", "a2")), elbow]
    both = Product("k12 a12 (b12 - l1) a2 = m2 g h2 l1", S2 * l1, "N m^2", ("k12", "a12", PAST, "a2"))
    return [Product("k2 a2 b2 = m2 g h2", S2, "N m", ("k2", "a2", "b2")), elbow, both]


def _defaults(arm: TwoLinks, layout: str, a2: int) -> dict[str, float]:
    """Lengths of the size of the links, with the signs of the layout; b2 is one only with three springs.

    Twice the usual b2 then, about h2: spring k2 takes less than the moment of link 1, and leaves k1 a b1 > 0.
    """
    upper, fore = arm.size
    a12, d, b2 = LAYOUTS[layout]
    return {"a2": a2 * upper, "b2": b2 * 2 * fore, "a12": a12 * fore, PAST: d * upper}


def _spring_1(arm: TwoLinks, left: Array, given: Mapping[str, float]) -> dict[str, float]:
    """k1, a1 and b1 for the moment `left` (3,) [N m] by the first line of (14)."""
    x1 = arm.l1 / np.linalg.norm(arm.l1)
    if np.linalg.norm(left) <= arm.chain.near * arm.chain.weight * arm.link[0].mass:
        raise InfeasibleError("spring k2 leaves nothing for spring k1 (14): springs=2 does")
    moment = float(left @ _along(left, x1))
    upper = arm.size[0]
    a1 = upper * _sign(moment * given.get("b1", moment))
    b1 = upper * _sign(moment * given.get("a1", 1.0))
    product = Product("k1 a1 b1 = m1 g h1 + m2 g l1 - k2 a2 l1", moment, "N m", ("k1", "a1", "b1"))
    return fill([product], given, {"a1": a1, "b1": b1})


def _along(left: Array, x1: Array) -> Array:
    """(3,) the unit vector of a moment, on the side of x1."""
    return left / np.linalg.norm(left) * _sign(float(left @ x1))


def _sign(x: float) -> int:
    return 1 if x >= 0 else -1


def _than(sign: int) -> str:
    return ">" if sign > 0 else "<"
