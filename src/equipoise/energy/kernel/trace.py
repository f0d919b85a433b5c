"""Arithmetic on symbols, folded as it is written down, and the straight-line program that comes of it.

A value is a float (a constant), or a whole number: the number of a node, negative for its negative. Equal nodes are
one; what is constant, zero or one vanishes. So the recursions can be written down naively, and the mechanism's zeros
and right angles cost nothing.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import inf

import numpy as np

from ...model.arrays import Array, Integers, frozen

Value = float | int
Vector = tuple[Value, Value, Value]

# codes of a program's operations on registers a, b, c and constants k, m
(ADD, SUB, MUL, ADDK, MULK, FMA, FMS, FNM, FMAK, FMSK, FMAM, SQRT, SHARE, INPUT, SINCOS, CLAMP, STEP,
 INVERSE) = range(18)  # fmt: skip
MEANING = ("a+b", "a-b", "a*b", "a+k", "a*k", "a*b+c", "a*b-c", "c-a*b", "a*k+c", "a*k-c", "a*k+m",
           "sqrt(a)", "a>0 ? 1-k/a : 0", "input k", "sin, cos of a", "min(max(a-k, 0), m)", "a>0 ? 1 : 0",
           "a>0 ? 1/a : 0")  # fmt: skip
_SIN, _COS = 100, 101


class Trace:
    """Nodes as they are made; see the module."""

    def __init__(self) -> None:
        self._nodes: list[tuple] = [()]
        self._known: dict[tuple, int] = {}

    def _node(self, *key: float) -> int:
        number = self._known.get(key)
        if number is None:
            self._nodes.append(key)
            number = self._known[key] = len(self._nodes) - 1
        return number

    def input(self, number: int) -> Value:
        """Input row `number`."""
        return self._node(INPUT, number)

    def sincos(self, a: Value) -> tuple[Value, Value]:
        """Sine and cosine."""
        if isinstance(a, float):
            return float(np.sin(a)), float(np.cos(a))
        s = self._node(_SIN, abs(a))
        return (s if a > 0 else -s), self._node(_COS, abs(a))

    def add(self, a: Value, b: Value) -> Value:
        """a + b."""
        if isinstance(a, float):
            if isinstance(b, float):
                return a + b
            a, b = b, a
        if isinstance(b, float):
            if b == 0.0:
                return a
            return self._node(ADDK, a, b) if a > 0 else -self._node(ADDK, -a, -b)
        if a == -b:
            return 0.0
        if a == b:
            return self.mul(2.0, a)
        if (a > 0) == (b > 0):
            low, high = sorted((abs(a), abs(b)))
            node = self._node(ADD, low, high)
            return node if a > 0 else -node
        plus, minus = (a, -b) if a > 0 else (b, -a)
        return self._node(SUB, plus, minus) if plus < minus else -self._node(SUB, minus, plus)

    def sub(self, a: Value, b: Value) -> Value:
        """a - b."""
        return self.add(a, -b)

    def mul(self, a: Value, b: Value) -> Value:
        """a * b."""
        if isinstance(b, float):
            if isinstance(a, float):
                return a * b
            a, b = b, a
        assert not isinstance(b, float)
        if isinstance(a, float):
            if a == 0.0:
                return 0.0
            if a < 0:
                a, b = -a, -b
            key = self._nodes[abs(b)]
            if key[0] == MULK:
                a, b = a * key[2], (key[1] if b > 0 else -key[1])
            if a == 1.0:
                return b
            node = self._node(MULK, abs(b), a)
            return node if b > 0 else -node
        low, high = sorted((abs(a), abs(b)))
        node = self._node(MUL, low, high)
        return node if (a > 0) == (b > 0) else -node

    def sqrt(self, a: Value) -> Value:
        """The square root."""
        return float(np.sqrt(a)) if isinstance(a, float) else self._node(SQRT, a)

    def share(self, length: Value, free: float) -> Value:
        """``1 - free/length``, 0 where the length is."""
        if isinstance(length, float):
            return 1 - free / length if length > 0 else 0.0
        return self._node(SHARE, length, free)

    def clamp(self, a: Value, low: float, width: float = inf) -> Value:
        """``min(max(a - low, 0), width)``: how far a has come through an interval."""
        if isinstance(a, float):
            return min(max(a - low, 0.0), width)
        return self._node(CLAMP, self._positive(a), low, width)

    def step(self, a: Value) -> Value:
        """1 where a is more than 0, else 0."""
        return float(a > 0) if isinstance(a, float) else self._node(STEP, self._positive(a))

    def inverse(self, a: Value) -> Value:
        """``1/a`` where a is more than 0, else 0."""
        if isinstance(a, float):
            return 1 / a if a > 0 else 0.0
        return self._node(INVERSE, self._positive(a))

    def _positive(self, a: int) -> int:
        """A node for a value, which may be the negative of one."""
        return a if a > 0 else self._node(MULK, -a, -1.0)

    def total(self, values: Sequence[Value]) -> Value:
        """The sum, a constant first: it then costs nothing beside a product."""
        found: Value = 0.0
        for value in sorted(values, key=lambda v: not isinstance(v, float)):
            found = self.add(found, value)
        return found

    def dot(self, a: Sequence[Value], b: Sequence[Value]) -> Value:
        """Scalar product."""
        return self.total([self.mul(x, y) for x, y in zip(a, b, strict=True)])

    def program(self, outputs: Sequence[Value]) -> Program:
        """What computes these outputs, dead nodes left out, products fused with the sum they go into."""
        return _Emitter(self._nodes, outputs).program()


@frozen
class Program:
    """Straight-line code: operation i is `code[i]` on the registers `a`, `b`, `c` and constants `k`, `m`, into `to`.

    SINCOS writes the sine to `to` and the cosine to `b`. Registers are used again once their value is no longer needed;
    no operation writes one that it reads.

    Attributes:
        code, to, a, b, c: (operations,) whole numbers.
        k, m: (operations,) constants.
        registers: how many there are.
        outputs: (outputs,) registers, -1 for a constant; sign: (outputs,) what each is multiplied by, or the constant.
        inputs: the number of rows read.
    """

    code: Integers
    to: Integers
    a: Integers
    b: Integers
    c: Integers
    k: Array
    m: Array
    registers: int
    outputs: Integers
    sign: Array
    inputs: int

    @property
    def cost(self) -> int:
        """Operations of a vector machine without counting sines, inputs and what is fused."""
        divisions = np.isin(self.code, (SQRT, SHARE, INVERSE)).sum()
        return int((~np.isin(self.code, (INPUT, SINCOS))).sum() + 15 * divisions)


class _Emitter:
    """Nodes -> program: fusing, order, registers."""

    def __init__(self, nodes: list[tuple], outputs: Sequence[Value]) -> None:
        self.nodes, self.outputs = nodes, outputs
        self.uses = [0] * len(nodes)
        stack = [abs(v) for v in outputs if not isinstance(v, float)]
        seen = set()
        while stack:
            node = stack.pop()
            self.uses[node] += 1
            if node not in seen:
                seen.add(node)
                stack.extend(self._operands(node))
        inputs = {node for node, key in enumerate(nodes) if key and key[0] == INPUT}
        self.inputs = len(inputs)  # all are read, used or not: one that is no number spoils its pose
        self.live = sorted(seen | inputs)
        self.rows: list[tuple[int, int, tuple[int, int, int], float, float]] = []

    def _operands(self, node: int) -> tuple[int, ...]:
        key = self.nodes[node]
        if key[0] in (ADD, SUB, MUL):
            return key[1], key[2]
        return () if key[0] == INPUT else (key[1],)

    def _fusable(self, node: int) -> bool:
        return self.uses[node] == 1 and self.nodes[node][0] in (MUL, MULK)

    def program(self) -> Program:
        fused = set()
        plan: dict[int, tuple[int, tuple[int, ...], float, float]] = {}
        for node in self.live:
            key = self.nodes[node]
            code, operands, k, m = key[0], tuple(self._operands(node)), 0.0, 0.0
            if code in (MULK, ADDK, SHARE, INPUT):
                k = float(key[-1])
            elif code == CLAMP:
                k, m = key[2], key[3]
            if code in (ADD, SUB):
                x, y = key[1], key[2]
                product = y if self._fusable(y) else x if self._fusable(x) else None
                if product is not None:
                    other = x if product == y else y
                    fused.add(product)
                    inner = self.nodes[product]
                    by_constant = inner[0] == MULK
                    operands = (inner[1], other) if by_constant else (inner[1], inner[2], other)
                    k = float(inner[2]) if by_constant else 0.0
                    if code == ADD:
                        code = FMAK if by_constant else FMA
                    elif product == x:
                        code = FMSK if by_constant else FMS
                    else:  # other - product
                        code, k = (FMAK, -k) if by_constant else (FNM, 0.0)
            elif code == ADDK and self._fusable(key[1]) and self.nodes[key[1]][0] == MULK:
                inner = self.nodes[key[1]]
                fused.add(key[1])
                code, operands, k, m = FMAM, (inner[1],), float(inner[2]), float(key[2])
            plan[node] = (code, operands, k, m)
        return self._allocate({node: row for node, row in plan.items() if node not in fused})

    def _allocate(self, plan: dict[int, tuple[int, tuple[int, ...], float, float]]) -> Program:
        """Order as written down; a sine and its cosine come together; registers are freed after their last use."""
        kept = {abs(v) for v in self.outputs if not isinstance(v, float)}
        last = {node: node for node in plan}
        for node, (_, operands, _, _) in plan.items():
            for operand in operands:
                last[operand] = node
        register: dict[int, int] = {}
        free: list[int] = []
        count = 0
        rows: list[tuple[int, int, int, int, int, float, float]] = []

        def take() -> int:
            nonlocal count
            if free:
                return free.pop()
            count += 1
            return count - 1

        angles: dict[int, list[int]] = {}
        for node, (code, operands, _, _) in plan.items():
            if code in (_SIN, _COS):
                angles.setdefault(operands[0], []).append(node)
        for node, (code, operands, k, m) in plan.items():
            if node in register:  # the other half of a sine and cosine
                continue
            regs = [register[operand] for operand in operands]
            if code in (_SIN, _COS):
                halves = {self.nodes[half][0]: half for half in angles[operands[0]]}
                to, other = take(), take()
                spare = []
                for kind, reg in ((_SIN, to), (_COS, other)):
                    if kind in halves:
                        register[halves[kind]] = reg
                    else:
                        spare.append(reg)
                rows.append((SINCOS, to, regs[0], other, 0, 0.0, 0.0))
                free += spare
                if last[operands[0]] <= max(angles[operands[0]]) and operands[0] not in kept:
                    free.append(regs[0])
                continue
            register[node] = take()
            for operand in set(operands):  # only now: an operation does not write where it reads
                if last[operand] == node and operand not in kept:
                    free.append(register[operand])
            a, b, c = (*regs, 0, 0, 0)[:3]
            if code in (FMAK, FMSK):
                b, c = 0, regs[1]
            rows.append((code, register[node], a, b, c, k, m))
        table = np.array(rows, float).reshape(-1, 7).T
        code, to, a, b, c = (np.ascontiguousarray(column, np.int32) for column in table[:5])
        k, m = (np.ascontiguousarray(column) for column in table[5:])
        outputs = np.array([-1 if isinstance(v, float) else register[abs(v)] for v in self.outputs], np.int32)
        sign = np.array([v if isinstance(v, float) else float(np.sign(v)) for v in self.outputs], float)
        return Program(code, to, a, b, c, k, m, count, outputs, sign, self.inputs)
