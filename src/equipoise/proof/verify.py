"""Check a certificate of balance (docs/certificates.md) by Python's standard library alone: python verify.py CERT.json

All is derived again from the mechanism's numbers, which are rational. What is not, sines and roots, is enclosed by
whole numbers of 2**-BITS, with a radius. An energy is a sum ``sum c q^d exp(ik.q)``, and so is every number.
"""

import json
import re
import sys
from fractions import Fraction
from math import isqrt, lcm, prod

BITS = 384
UNIT = 1 << BITS
PARALLEL = Fraction(1, 10**9)  # the sine of an angle between axes that count as parallel
LOADED = Fraction(1, 10**7)  # of all moments before anything cancels: what gravity certainly loads
NUMBER = re.compile(r"-?\d{1,700}(/[1-9]\d{0,700}|(\.\d{1,40})?(e[+-]?\d{1,3})?)")


class Sum(dict):
    """(k, d) -> (a, b, r): real and imaginary parts of c are within r of a and b; k in units of 1/`Tree.unit`."""

    def __add__(self, other):
        total = Sum(self)
        for key, (c, d, s) in other.items():
            a, b, r = total.get(key, (0, 0, 0))
            total[key] = a + c, b + d, r + s
        return Sum({key: c for key, c in total.items() if any(c)})

    def __mul__(self, other):
        total = Sum()
        for one, (a, b, r) in self.items():
            for two, (c, d, s) in other.items():
                key = tuple(map(int.__add__, one, two))
                x, y, z = total.get(key, (0, 0, 0))
                off = (abs(a) + abs(b) + 2 * r) * s + (abs(c) + abs(d)) * r >> BITS
                total[key] = x + (a * c - b * d >> BITS), y + (a * d + b * c >> BITS), z + off + 2
        return total

    def conjugate(self):
        return Sum({tuple(-k for k in key): (a, -b, r) for key, (a, b, r) in self.items()})  # of what has no powers


def dot(v, w):
    return sum((x * y for x, y in zip(v, w, strict=True)), Sum())


def add(*vectors):
    return [sum(each, Sum()) for each in zip(*vectors, strict=True)]


def number(text):
    if not isinstance(text, str) or not NUMBER.fullmatch(text):
        raise ValueError(f"{str(text)[:40]!r} is no number")
    return Fraction(text)


def vector(texts):
    return [number(texts[i]) for i in range(3)]


class Tree:
    """A mechanism: how each body hangs on the others, and the energy."""

    def __init__(self, data):
        self.data, self.names, self.of = data, data["coordinates"], {"world": {}}
        self.zero, self.motions = (0,) * len(self.names), [m for j in data["joints"] for m in j["turns"] + j["slides"]]
        ratios = [item for motion in self.motions + data["springs"] for item in motion.get("by", {}).items()]
        self.unit = lcm(*(number(ratio).denominator for x, ratio in ratios if self.names.index(x) >= 0))
        self.eye = [[self.constant(i == j) for j in range(3)] for i in range(3)]
        for joint in data["joints"]:
            if joint["child"] in self.of or not {joint["parent"], joint["base"]} <= {*self.of}:
                raise ValueError(f"body {joint['child']!r} does not hang on what comes before it")
            R, step = self.eye, [*map(self.constant, vector(joint["xyz"]))]
            for turn in joint["turns"]:  # Rodrigues: its columns
                a, (c, s), less, T = self.along(turn), self.waves(turn), self.constant(-1), [[], [], []]
                for i, j in ((i, j) for i in range(3) for j in range(3)):
                    across = (Sum(), s * a[i - 1] * less, s * a[j - 1])[(j - i) % 3]
                    T[j].append(a[i] * a[j] + c * (self.eye[i][j] + a[i] * a[j] * less) + across)
                R = [[dot(column, row) for column in T] for row in R]
            for slide in joint["slides"]:
                step = add(step, [dot(row, self.along(slide)) * self.itself(slide) for row in R])
            self.of[joint["child"]] = {**joint, "R": R, "step": step}

    def constant(self, x, i=0):
        """A number, or that times i."""
        a, left = divmod(Fraction(x).numerator << BITS, Fraction(x).denominator)
        return Sum({self.zero * 2: (0, a, bool(left)) if i else (a, 0, bool(left))} if x else {})

    def circle(self, x):
        """exp(ix): its series for a small part of x, squared again and again."""
        doublings = max(0, abs(x.numerator).bit_length() - x.denominator.bit_length() + 2)
        step, term, total = self.constant(x / 2**doublings, i=1), self.constant(1), Sum({self.zero * 2: (0, 0, 1)})
        for n in range(1, 90):  # powers of less than 1/2: what is left out is below 2**-89 / 89!, less than a unit
            total, term = total + term, term * step * self.constant(Fraction(1, n))
        for _ in range(doublings):
            total = total * total
        return total

    def along(self, motion):
        """The unit vector of its axis."""
        axis = vector(motion["axis"])
        sizes = [isqrt((x * x / sum(y * y for y in axis) * UNIT**2).__floor__()) for x in axis]
        return [Sum({self.zero * 2: (a if x > 0 else -a, 0, 1)} if x else {}) for x, a in zip(axis, sizes, strict=True)]

    def itself(self, motion):
        """The value of a motion: a sum of coordinates with ratios, and an offset."""
        powers = {x: Sum({(*self.zero, *(int(x == name) for name in self.names)): (UNIT, 0, 0)}) for x in motion["by"]}
        parts = (powers[x] * self.constant(number(ratio)) for x, ratio in motion["by"].items())
        return sum(parts, self.constant(number(motion["from"])))

    def waves(self, motion, times=1):
        """The cosine and sine of such a value, or of a multiple."""
        turn = (int(times * self.unit * number(motion["by"].get(x, "0"))) for x in self.names)
        half = self.circle(times * number(motion["from"])) * Sum({(*turn, *self.zero): (UNIT >> 1, 0, 0)})
        return half + half.conjugate(), half * self.constant(-1, i=1) + half.conjugate() * self.constant(1, i=1)

    def point(self, body, p, factor: int | Fraction = 1):
        """A point of a body times a factor, as the sum over bodies X of R_X v_X: [(X, v_X)]."""
        found, joint = [(body, [self.constant(factor * x) for x in p])], self.of[body]
        while joint:
            found.append((joint["parent"], [x * self.constant(factor) for x in joint["step"]]))
            joint = self.of[joint["parent"]]
        return found

    def between(self, ends):
        (a, p_a), (b, p_b) = ((ends[f"body_{x}"], vector(ends[f"p_{x}"])) for x in "ab")
        return self.point(b, p_b) + self.point(a, p_a, -1)

    def weight(self, springs):
        masses = self.data["masses"] + (self.data["spring_masses"] if springs else [])
        return [step for m in masses for step in self.point(m["body"], vector(m["position"]), number(m["mass"]))]

    def products(self, vectors, squares=True):
        """The scalar products of such sums, where ``R_X' R_X = 1`` for what hangs on one body; and their values."""
        fixed, hung, many, whole = {}, {}, range(len(vectors)), []
        found = [[Sum() for _ in vectors] for _ in vectors]
        for i, X, v in ((i, X, v) for i, each in enumerate(vectors) for X, v in each):
            own = fixed.setdefault(X, [[Sum()] * 3 for _ in many])
            own[i] = add(own[i], v)
        for X in reversed(self.of):
            at_X = fixed[X] if any(map(any, fixed.get(X, []))) else None
            own = hung.get(X, []) + ([at_X] if at_X else [])
            for p, q in ((p, q) for p in own for q in own if squares and (p is not q or p is at_X)):
                for i, j in [(i, j) for i in many for j in many if j <= i]:
                    found[i][j] += dot(p[i], q[j])
            whole = [add([Sum()] * 3, *each) for each in zip([[Sum()] * 3] * len(many), *own, strict=True)]
            if own and (joint := self.of[X]):
                hung.setdefault(joint["base"], []).append([[dot(row, v) for row in joint["R"]] for v in whole])
        return found, whole

    def energy(self, springs):
        """Of gravity; and of the springs, and of gravity on them, where they count. Without what is constant."""
        _, (moment,) = self.products([self.weight(springs)], squares=False)
        U = dot([self.constant(-x) for x in vector(self.data["gravity"])], moment)
        for one in self.data["springs"] if springs else []:
            if "by" in one:
                c1, c2 = (self.constant(number(x)) for x in one["powers"])
                U += self.itself(one) * (c1 + c2 * self.itself(one))
                for times, amounts in enumerate(one["waves"], 1):
                    U += dot([self.constant(number(x)) for x in amounts], self.waves(one, times))
            else:
                U += self.products([self.between(one)])[0][0][0] * self.constant(number(one["stiffness"]) / 2)
        return {key: c for key, c in U.items() if any(key)}


def sizes(tree, U, within):
    """Of each term that varies: its frequencies, the slopes of its powers, and its size where what slides ends."""
    reach = {x: abs(number(text)) for x, text in within.items()}
    for key, (a, b, r) in U.items():
        powers = {x: d for x, d in zip(tree.names, key[len(tree.zero) :], strict=True) if d}
        size = Fraction(isqrt(a * a + b * b) + 1 + 2 * r, UNIT) * prod(reach[x] ** d for x, d in powers.items())
        frequencies, slopes = dict(zip(tree.names, key, strict=False)), {x: d / reach[x] for x, d in powers.items()}
        yield from [(frequencies, slopes, size)] if any(key) else []


def check_torque(tree, claim, _):
    """``|dU/dq_j| <= sum |c| |d/dq_j q^d exp(ik.q)|``."""
    bound = dict.fromkeys(tree.names, Fraction(0))
    for frequencies, powers, size in sizes(tree, tree.energy(True), claim["within"]):
        for x, k in frequencies.items():
            bound[x] += size * (Fraction(abs(k), tree.unit) + powers.get(x, 0))
    for x in {*bound, *claim["at_most"]}:
        if bound[x] > number(claim["at_most"][x]):
            raise ValueError(f"the torque at {x!r} is not proved to be at most {claim['at_most'][x]}")


def check_closed(tree, claim, forces):
    """Where the loops close, constant forces across them, in frames of bodies, add nothing to the energy."""
    U = Sum(tree.energy(True))
    for i, body, *force in forces:
        across = [tree.between(claim["loops"][i]), [(body, [*map(tree.constant, vector(force))])]]
        U += tree.products(across)[0][1][0]
    if sum(size for _, _, size in sizes(tree, U, claim["within"])) > number(claim["energy"]):
        raise ValueError(f"the energy is not proved to vary by at most {claim['energy']} where the loops close")


def check_bound(tree, claim, proof):
    """The root mean square of a torque is at least its mean product with a trial torque, over the size of that one.

    The trial is the derivative of an energy, so that the product is a sum over terms. That of a spring of stiffness k
    is ``k y'S y`` with y = [1, u_a, u_b], where u are its ends in their regions' own coordinates. Where S plus `shift`,
    less multiples of what is not negative there, is positive definite, it is at least ``-k shift``.
    """
    counted, trial = [number(claim["counted"].get(x, "0")) / tree.unit for x in tree.names], Sum()
    for *k, a, b in proof["trial"]:
        c = (tree.constant(number(a)) + tree.constant(number(b), i=1)) * Sum({(*map(int, k), *tree.zero): (UNIT, 0, 0)})
        trial += c + c.conjugate()

    def mean(U):
        """With the trial: (middle, radius)."""
        middle = radius = Fraction(0)
        for key, (a, b, r) in U.items():
            (c, d, s), weight = trial.get(key, (0, 0, 0)), sum((x * k) ** 2 for x, k in zip(counted, key, strict=False))
            middle += weight * (a * c + b * d) / UNIT**2
            radius += weight * ((abs(a) + abs(b) + 2 * r) * s + (abs(c) + abs(d)) * r) / UNIT**2
            if any(key[len(tree.zero) :]):
                raise ValueError("what slides has no mean over all configurations")
        return middle, radius

    for pair, own in zip(claim["pairs"], proof["pairs"], strict=True):
        a, b, one, two = (pair[key] for key in ("body_a", "body_b", "region_a", "region_b"))
        half = [1, *vector(one["half"]), *vector(two["half"])]
        columns = [tree.between({**pair, "p_a": one["centre"], "p_b": two["centre"]})]
        for i in range(1, 7):
            v = [half[i] * ((i - 1) % 3 == j) * (-1 if i < 4 else 1) for j in range(3)]
            columns.append([(a if i < 4 else b, [*map(tree.constant, v)])])
        means = [[mean(U) for U in row] for row in tree.products(columns)[0]]
        S = [[means[max(i, j)][min(i, j)][0] / 2 for j in range(7)] for i in range(7)]
        for kind, i, s, j, t, amount in own:
            form = [(0, 0, 1), (0, i, s), (0, j, t), (i, j, s * t)]  # (1 + s u_i)(1 + t u_j) >= 0, in a ball too
            if kind == "ball" and (one, two)[i > 3]["shape"] == "ball":  # 1 - |u|^2 >= 0
                form = [(0, 0, 1), *((x, x, -1) for x in ((1, 2, 3), (4, 5, 6))[i > 3])]
            elif kind != "box" or not {s, t} <= {1, -1} or not {i, j} <= {*range(1, 7)}:
                raise ValueError(f"no region keeps {[kind, i, s, j, t]}")
            for x, y, factor in form + [(y, x, factor) for x, y, factor in form]:
                S[x][y] -= abs(number(amount)) * factor / 2
        S[0][0] += abs(number(proof["shift"]))
        used, off = [i for i in range(7) if half[i]], 7 * max(radius for row in means for _, radius in row)
        S = [[S[i][j] - off * (i == j) for j in used] for i in used]
        while S:  # one step of Gauss's elimination
            if S[0][0] <= 0:
                raise ValueError(f"the matrix of {a}:{b} is not positive definite")
            S = [[x - row[0] * y / S[0][0] for x, y in zip(row[1:], S[0][1:], strict=True)] for row in S[1:]]
    (middle, radius), (size, wide) = mean(tree.energy(False)), mean(trial)
    least = middle - radius - abs(number(proof["shift"]) * number(claim["stiffness"]))
    if least <= 0 or least**2 < number(claim["at_least"]) ** 2 * (size + wide):
        raise ValueError(f"it is not proved that at least {claim['at_least']} is left")


def check_fewest(tree, claim, _):
    """A planar section needs as many springs as it has links that gravity loads (docs/theorems.md)."""
    q, e = {x: number(claim["held"].get(x, "0")) for x in tree.names}, vector(claim["axis"])

    def held(motion):
        value = number(motion["from"]) + sum(q[x] * number(ratio) for x, ratio in motion["by"].items())
        return {"axis": motion["axis"], "by": {}, "from": str(value)}

    def across(v):
        """How much of a vector is at right angles to the axis, and how large it is; by the middles of the balls."""
        x = [Fraction(one.get(tree.zero * 2, (0, 0, 0))[0], UNIT) for one in v]
        return sum(abs(x[i - 2] * e[i - 1] - x[i - 1] * e[i - 2]) for i in range(3)), sum(map(abs, x))

    joints = [{**j, **{key: [*map(held, j[key])] for key in ("turns", "slides")}} for j in tree.data["joints"]]
    still, head, moments, whole = Tree({**tree.data, "joints": joints, "springs": []}), {"world": "world"}, {}, 0
    for body, joint in [*still.of.items()][1:]:
        head[body] = body if body in claim["links"] else head[joint["base"]]
    for X, v in still.weight(False):
        moments.setdefault(head[X], []).append((X, v))
        whole += across(v)[1]
    level, g = across([tree.constant(number(x)) for x in tree.data["gravity"]])
    for body in {*claim["links"]}:
        own, driven = [m for m in tree.of[body]["turns"] if m["by"]], [x for m in tree.motions for x in m["by"]]
        load, axis = still.products([moments[body], [(body, tree.along(own[0]))]], squares=False)[1]
        ball = [turn["axis"] for turn in own] == [[str(int(i == j)) for j in range(3)] for i in range(3)]
        about = ball or (len(own) == 1 and across(axis)[0] <= PARALLEL * max(map(abs, e)))
        alone = all(driven.count(*turn["by"]) == 1 for turn in own) and own == tree.of[body]["turns"][-len(own) :]
        if not (about and alone and across(load)[0] * level > LOADED * whole * g * sum(map(abs, e)) ** 2):
            raise ValueError(f"{body!r} does not turn by itself about the section's axis, or gravity does not load it")
    if len({*claim["links"]}) < claim["springs"]:
        raise ValueError(f"{claim['springs']} springs are not proved to be needed")


def check(certificate):
    """The names of its claims; ValueError where one is not proved, that or other errors where it is malformed."""
    if certificate["format"] != "equipoise certificate 1" or not certificate["claims"]:
        raise ValueError("this is no certificate of equipoise, version 1")
    tree = Tree(certificate["mechanism"])
    checks = {"torque": check_torque, "closed": check_closed, "bound": check_bound, "fewest": check_fewest}
    for name, claim in certificate["claims"].items():
        checks[name](tree, claim, certificate["proof"].get(name))
    return tuple(certificate["claims"])


if __name__ == "__main__":
    try:
        with open(sys.argv[1], encoding="utf-8") as file:
            print("accepted:", *check(json.load(file)))
    except Exception as why:
        sys.exit(f"refused: {why if isinstance(why, ValueError) else repr(why)}")
