"""Certificates that somebody has tampered with, and an evaluation of its own that says whether they still hold.

It asks the ball arithmetic of python-flint about torque and bound, and plain double precision about the section; the
program under test shares no code with either.
"""

from __future__ import annotations

import copy
from collections.abc import Iterator
from fractions import Fraction
from typing import Any

import numpy as np

from equipoise.proof.enclosure import Enclosure

Place = tuple[Any, Any]  # a container and a key in it
STRONGER = Fraction(1, 10**6)


def number(text: str) -> Fraction:
    return Fraction(text)


def numbers(value: Any) -> Iterator[Place]:
    """Where the numbers of a part of a certificate are."""
    for key, one in value.items() if isinstance(value, dict) else enumerate(value):
        if isinstance(one, (dict, list)):
            yield from numbers(one)
        elif isinstance(one, str) and one.lstrip("-")[:1].isdigit():
            yield value, key


def tampered(document: dict[str, Any], seed: int) -> tuple[dict[str, Any], str]:
    """A certificate in which something is not as it was, and what."""
    rng = np.random.default_rng(seed)
    found = copy.deepcopy(document)
    claims, proof = found["claims"], found["proof"]
    parts = {"mechanism": found["mechanism"], "claims": claims}
    if proof:
        parts["proof"] = proof
    kind = str(rng.choice(["mechanism", "mechanism", "claims", "stronger", "structure", "proof"]))
    if kind == "stronger" or (kind == "proof" and not proof):
        return found, f"stronger: {_strengthened(claims, rng)}"
    if kind == "structure":
        return found, f"structure: {_restructured(found, rng)}"
    places = [*numbers(parts[kind])]
    container, key = places[int(rng.integers(len(places)))]
    old = number(container[key])
    size = Fraction(float(10.0 ** rng.uniform(-14, 0)))
    change = (old or Fraction(1)) * size * int(rng.choice([-1, 1]))
    container[key] = str(-old if old and rng.random() < 0.1 else old + change)
    return found, f"{kind}: {key}: {float(old):.6g} by {float(change):.3g}"


def _strengthened(claims: dict[str, Any], rng: np.random.Generator) -> str:
    name = str(rng.choice([*claims]))
    claim = claims[name]
    if name == "fewest":
        claim["springs"] += 1
    elif name == "bound":
        claim["at_least"] = str(number(claim["at_least"]) * (1 + STRONGER))
    elif name == "closed":
        claim["energy"] = str(number(claim["energy"]) * (1 - STRONGER))
    else:
        joint = str(rng.choice([*claim["at_most"]]))
        claim["at_most"][joint] = str(number(claim["at_most"][joint]) * (1 - STRONGER))
    return name


def _restructured(found: dict[str, Any], rng: np.random.Generator) -> str:
    """Something is left out, twice there, or elsewhere."""
    mechanism, claims, proof = found["mechanism"], found["claims"], found["proof"]
    lists = [mechanism[key] for key in ("joints", "masses", "springs", "coordinates") if mechanism[key]]
    if "fewest" in claims:
        lists.append(claims["fewest"]["links"])
    if "bound" in claims:
        lists += [proof["bound"]["trial"], *(own for own in proof["bound"]["pairs"] if own), claims["bound"]["pairs"]]
    chosen = lists[int(rng.integers(len(lists)))]
    i = int(rng.integers(len(chosen)))
    what = str(rng.choice(["left out", "twice", "moved"]))
    if what == "left out":
        del chosen[i]
    elif what == "twice":
        chosen.append(copy.deepcopy(chosen[i]))
    else:
        chosen.insert(int(rng.integers(len(chosen))), chosen.pop(i))
    return what


def holds(document: dict[str, Any]) -> bool:
    """Whether every claim follows, as far as this evaluation sees."""
    try:
        if not _hangs(document["mechanism"]):
            return False
        enclosure = Enclosure(document["mechanism"])
        checks = {"torque": _torque, "bound": _bound, "fewest": _fewest, "closed": _closed}
        return all(
            checks[name](enclosure, claim, document["proof"].get(name)) for name, claim in document["claims"].items()
        )
    except (LookupError, ValueError, TypeError, ZeroDivisionError, RuntimeError):
        return False


def _hangs(mechanism: dict[str, Any]) -> bool:
    """Whether each body hangs on bodies before it, and masses and springs on bodies that there are."""
    there = {"world"}
    for joint in mechanism["joints"]:
        if joint["child"] in there or not {joint["parent"], joint["base"]} <= there:
            return False
        there.add(joint["child"])
    held = {mass["body"] for mass in (*mechanism["masses"], *mechanism["spring_masses"])}
    held |= {one[key] for one in mechanism["springs"] for key in ("body_a", "body_b") if key in one}
    motions = [m for joint in mechanism["joints"] for m in (*joint["turns"], *joint["slides"])] + mechanism["springs"]
    return held <= there and {x for m in motions for x in m.get("by", ())} <= {*mechanism["coordinates"]}


def _torque(enclosure: Enclosure, claim: dict[str, Any], _: Any) -> bool:
    within = {name: abs(number(x)) for name, x in claim["within"].items()}
    if not {*enclosure.powers} <= {*within}:
        return False
    most = dict(zip(enclosure.names, enclosure.torque(within), strict=True))
    return most.keys() == claim["at_most"].keys() and all(x <= number(claim["at_most"][n]) for n, x in most.items())


def _closed(enclosure: Enclosure, claim: dict[str, Any], proof: list[Any]) -> bool:
    within = {name: abs(number(x)) for name, x in claim["within"].items()}
    if not {*enclosure.powers} <= {*within}:
        return False
    total = dict(enclosure.energy())
    for i, body, *force in proof:
        for terms, x in zip(enclosure.gap(claim["loops"][i], body), force, strict=True):
            for key, c in terms.items():
                total[key] = total.get(key, 0) + c * enclosure.number(x)
    return enclosure.varies(total, within) <= number(claim["energy"])


def _bound(enclosure: Enclosure, claim: dict[str, Any], proof: dict[str, Any]) -> bool:
    names = len(enclosure.names)
    weight = [(number(claim["counted"].get(n, "0")) / enclosure.unit) ** 2 for n in enclosure.names]
    trial: dict[Any, Any] = {}
    for row in proof["trial"]:
        key = tuple(map(int, row[:names]))
        for k, sign in ((key, 1), (tuple(-x for x in key), -1)):
            trial[k] = trial.get(k, 0) + enclosure.number(row[names], sign * number(row[names + 1]))

    def mean(terms: Any) -> Any:
        total = enclosure.number(0)
        for key, c in terms.items():
            if any(key[names:]):
                raise ValueError("powers")
            if key[:names] in trial:
                w = enclosure.number(sum((x * k * k for x, k in zip(weight, key, strict=False)), Fraction(0)))
                total = c * (trial[key[:names]].conjugate() * w) + total
        return total

    shift, zero = abs(number(proof["shift"])), enclosure.zero
    if len(claim["pairs"]) != len(proof["pairs"]):
        return False
    for pair, own in zip(claim["pairs"], proof["pairs"], strict=True):
        lift = np.full((7, 7), Fraction(0))
        a, b, one, two = (pair[key] for key in ("body_a", "body_b", "region_a", "region_b"))
        lift[3, 3] = Fraction(1)
        half = [Fraction(1)] * 7
        for start, region in ((0, one), (4, two)):
            for i in range(3):
                lift[start + i, start + i] = half[start + i] = number(region["half"][i])
                lift[start + i, 3] = number(region["centre"][i])
        terms = {key: M for key, M in enclosure.form(a, b, lift.tolist()).items() if any(key)}
        S = np.full((7, 7), enclosure.number(0).real)
        for i in range(7):
            for j in range(7):
                S[i, j] = mean({key: M[i, j] for key, M in terms.items()}).real + 0
        S[3, 3] = S[3, 3] + enclosure.number(shift).real
        place = [3, 0, 1, 2, 4, 5, 6]
        for kind, i, s, j, t, amount in own:
            mu = enclosure.number(abs(number(amount))).real
            if kind == "ball" and (one if i <= 3 else two)["shape"] == "ball":
                S[3, 3] = S[3, 3] - mu
                for x in (0, 1, 2) if i <= 3 else (4, 5, 6):
                    S[x, x] = S[x, x] + mu
            elif kind == "box" and {s, t} <= {1, -1} and {i, j} <= {*range(1, 7)}:
                y = np.full((2, 7), 0)
                y[0, 3], y[1, 3] = 1, 1
                y[0, place[i]], y[1, place[j]] = s, t
                S = S - np.array(
                    [[mu * int(y[0, p] * y[1, q] + y[0, q] * y[1, p]) / 2 for q in range(7)] for p in range(7)]
                )
            else:
                return False
        used = [i for i in range(7) if half[i]]
        if not _definite(S[np.ix_(used, used)]):
            return False
    load = {key: c for key, c in enclosure.load().items() if key != zero}
    least = mean(load).real - enclosure.number(shift * abs(number(claim["stiffness"]))).real
    size = mean({(*k, *zero[names:]): c for k, c in trial.items()}).real
    return bool(least > 0 and least * least >= enclosure.number(number(claim["at_least"]) ** 2).real * size)


def _definite(S: Any) -> bool:
    """By Cholesky's factor, in balls."""
    n = len(S)
    L = np.full((n, n), S[0, 0] * 0)
    for j in range(n):
        pivot = S[j, j] - sum((L[j, k] * L[j, k] for k in range(j)), S[0, 0] * 0)
        if not pivot > 0:
            return False
        L[j, j] = pivot.sqrt()
        for i in range(j + 1, n):
            L[i, j] = (S[i, j] - sum((L[i, k] * L[j, k] for k in range(j)), S[0, 0] * 0)) / L[j, j]
    return True


def _fewest(enclosure: Enclosure, claim: dict[str, Any], _: Any) -> bool:
    """In double precision, with the weights beyond each link put at its joints one by one."""
    data, links = enclosure.data, {*claim["links"]}
    q = {name: float(number(claim["held"].get(name, "0"))) for name in enclosure.names}
    e, g = (np.array([float(number(x)) for x in v]) for v in (claim["axis"], data["gravity"]))
    joints = {joint["child"]: joint for joint in data["joints"]}
    R, p, moments, axes = {"world": np.eye(3)}, {"world": np.zeros(3)}, {}, {}

    def value(motion: dict[str, Any]) -> tuple[np.ndarray, float]:
        axis = np.array([float(number(x)) for x in motion["axis"]])
        s = sum(float(number(x)) * q[n] for n, x in motion["by"].items()) + float(number(motion["from"]))
        return axis / np.linalg.norm(axis), s

    for body, joint in joints.items():
        turn = np.eye(3)
        for motion in joint["turns"]:
            (x, y, z), s = value(motion)
            K = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
            turn = turn @ (np.eye(3) + np.sin(s) * K + (1 - np.cos(s)) * K @ K)
        R[body] = R[joint["base"]] @ turn
        step = np.array([float(number(x)) for x in joint["xyz"]])
        for motion in joint["slides"]:
            axis, s = value(motion)
            step = step + s * turn @ axis
        p[body] = R[joint["parent"]] @ step
        moving = [motion for motion in joint["turns"] if motion["by"]]
        axes[body] = [R[body] @ value(motion)[0] for motion in moving]

    def head(body: str) -> str:
        return body if body == "world" or body in links else head(joints[body]["base"])

    whole = 0.0
    for mass in data["masses"]:
        m, body = float(number(mass["mass"])), mass["body"]
        steps = [(body, R[body] @ [float(number(x)) for x in mass["position"]])]
        while body != "world":
            steps.append((joints[body]["parent"], p[body]))
            body = joints[body]["parent"]
        for X, v in steps:
            moments[head(X)] = moments.get(head(X), np.zeros(3)) + m * v
            whole += m * float(np.abs(v).sum())
    motions = [m for joint in data["joints"] for m in (*joint["turns"], *joint["slides"])]
    driven = [name for motion in motions for name in motion["by"]]
    for body in links:
        own = [motion for motion in joints[body]["turns"] if motion["by"]]
        ball = len(own) == 3 and [m["axis"] for m in own] == [["1", "0", "0"], ["0", "1", "0"], ["0", "0", "1"]]
        if not (ball or len(own) == 1) or any(len(m["by"]) != 1 or driven.count(*m["by"]) != 1 for m in own):
            return False
        if not ball and np.abs(np.cross(axes[body][0], e)).sum() > 1e-9 * np.abs(e).max():
            return False
        load = np.abs(np.cross(moments.get(body, np.zeros(3)), e)).sum() * np.abs(np.cross(g, e)).sum()
        if load <= 1e-7 * whole * np.abs(g).sum() * np.abs(e).sum() ** 2:
            return False
    return len(links) >= claim["springs"]
