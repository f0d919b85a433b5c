"""How tight the bound is with boxes, before the products of the bounds were in the program and with them.

`python benchmarks/gaps.py [--count N]`: N random arms with parallel or crossed axes, boxes that may be flat, span 2.
The gap is (best design found - bound) / unbalanced; one below zero would be a wrong bound, and ends the run.
"""

from __future__ import annotations

import argparse
from dataclasses import replace
from itertools import islice

import numpy as np

import equipoise as eq
from equipoise.model.arrays import vec3
from equipoise.synthesis.convex.few_springs import SpringSearch
from equipoise.synthesis.convex.goal import Rms
from equipoise.synthesis.convex.least_squares_form import build
from equipoise.synthesis.convex.semidefinite import least_rms
from equipoise.synthesis.convex.spring_block import SpringBlock

SHARES = (0, 10, 25, 50, 75, 90, 100)  # percentiles
SPRINGS = 6


class WithoutProducts(SpringBlock):
    """The moment matrix and its diagonal alone."""

    def cones(self):
        return islice(super().cones(), 2)


def arm(seed: int) -> eq.Problem:
    """Two or three links, and a box for each body with half sides of which some are zero."""
    rng = np.random.default_rng(seed)
    count = int(rng.integers(2, 4))
    names = ["world", "a", "b", "c"][: count + 1]
    axes = [(0.0, 1.0, 0.0) if seed % 2 else vec3(rng.normal(size=3)) for _ in range(count)]
    mechanism = eq.Mechanism(
        f"arm {seed}",
        tuple(eq.Body(name, float(rng.uniform(0.5, 4)), vec3(rng.uniform(-0.3, 0.3, 3))) for name in names[1:]),
        tuple(
            eq.Joint(f"j{i}", "revolute", names[i], names[i + 1], vec3(rng.uniform(-0.3, 0.3, 3)), axis=axes[i])
            for i in range(count)
        ),
    )
    regions = {}
    for name in names:
        half = rng.uniform(0.05, 0.3, 3) * (rng.random(3) < 0.7)
        regions[name] = eq.Region.box(half.tolist(), rng.uniform(-0.1, 0.1, 3).tolist())
    return eq.Problem.of(mechanism, span=2, regions=regions)


def main() -> None:
    parser = argparse.ArgumentParser(description="Gaps with boxes")
    parser.add_argument("--count", type=int, default=60)
    gaps = []
    for seed in range(parser.parse_args().count):
        reduced = build(arm(seed))
        if not reduced.useful or reduced.unbalanced < 1e-9:
            continue
        reduced = reduced.on(reduced.useful)
        fields = ("body_a", "body_b", "region_a", "region_b")
        loose = tuple(WithoutProducts(*(getattr(block, name) for name in fields)) for block in reduced.blocks)
        before, search = least_rms(replace(reduced, blocks=loose)).value, SpringSearch(Rms(reduced), most=SPRINGS)
        found, bound = search.best(SPRINGS), search.floor
        value = min(1.0, 1.0 if found is None else found.value)
        assert value >= bound - 1e-8, (seed, value, bound)
        gaps.append((value - before, value - bound))
    print(f"gap in % of the unbalanced torque, {len(gaps)} arms with boxes, at most {SPRINGS} springs")
    print("percentile       " + "".join(f"{share:>9}" for share in SHARES))
    for name, each in zip(("without products", "with products   "), np.maximum(100 * np.array(gaps).T, 0), strict=True):
        print(name + " " + "".join(f"{x:9.3g}" for x in np.percentile(each, SHARES)))


if __name__ == "__main__":
    main()
