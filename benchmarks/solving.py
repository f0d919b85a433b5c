"""Speed of the convex solve, the exact certificate and what they rest on."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import arms
import numpy as np
from measure import seconds

import equipoise as eq
from equipoise.energy import FourierEnergy, Potential
from equipoise.hardware.stock.made_up import made_up_catalogue
from equipoise.hardware.stock.selection import choose
from equipoise.model.errors import EquipoiseWarning
from equipoise.robust import tolerance
from equipoise.synthesis import Problem
from equipoise.synthesis.convex.least_squares_form import LeastSquaresForm, build
from equipoise.synthesis.convex.semidefinite import least_rms
from equipoise.synthesis.convex.spring_block import smat

ROBOTS = Path(__file__).parents[1] / "examples" / "robots"


def line(what: str, first: float, second: float, names: tuple[str, str]) -> None:
    print(f"{what}: {names[0]} {1e3 * first:.3g} ms, {names[1]} {1e3 * second:.3g} ms, ratio {second / first:.3g}")


def by_cvxpy(gram: LeastSquaresForm) -> Callable[[], object]:
    """The same program through a modelling language (its textbook form, same solver)."""
    import cvxpy as cp

    def solve() -> object:
        N = [cp.Variable((7, 7), PSD=True) for _ in gram.problem.pairs]
        scale = 1 / max(np.abs(columns).max() for columns in gram.columns)
        every = [scale * smat(columns) for columns in gram.columns]
        w = sum(Q.reshape(len(Q), -1) @ cp.reshape(M, 49, order="C") for Q, M in zip(every, N, strict=True))
        limits = [sum(M[i, i] for i in end) <= M[3, 3] for M in N for end in ((0, 1, 2), (4, 5, 6))]
        torque = cp.norm(cp.hstack([w + gram.d, gram.rest]))
        return cp.Problem(cp.Minimize(torque), limits).solve(solver=cp.CLARABEL)

    return solve


def warm() -> list[tuple[str, float]]:
    """Seconds of what a user waits for, once everything is loaded."""
    warnings.simplefilter("ignore", EquipoiseWarning)
    gram = build(Problem.of(eq.load(ROBOTS / "ur5.urdf"), span=2, radius=0.15))
    six, eight = arms.chain(6), arms.chain(8)
    tasks = {
        "convex solve, UR5, span 2": lambda: least_rms(gram),
        "check, UR5 with 5 springs": lambda: eq.check(arms.ur5(5)),
        "exact certificate, 6 skew joints, 6 springs": lambda: FourierEnergy(six).exact,
        "check, 6 skew joints, 6 springs": lambda: eq.check(six),
        "exact certificate, 8 skew joints, 8 springs": lambda: FourierEnergy(eight).exact,
        "check, 8 skew joints, 8 springs": lambda: eq.check(eight),
    }
    return list(zip(tasks, seconds(*tasks.values(), repeat=3), strict=True))


def long() -> list[tuple[str, float]]:
    """Seconds of what shows its progress."""
    ur5 = eq.design(eq.load(ROBOTS / "ur5.urdf"), span=3, radius=0.15, shape="box", springs=3)
    lee = eq.check(eq.load(ROBOTS.parent / "mechanisms" / "lee2014_table5a.yaml"))
    tasks = {
        "tolerance of UR5's design, 100,000 builds of 1,000 poses": lambda: tolerance(ur5.mechanism),
        "proven best of 2,000 springs in stock for lee2014's arm": lambda: choose(lee, made_up_catalogue(2000)),
    }
    return list(zip(tasks, seconds(*tasks.values(), repeat=1), strict=True))


def main() -> None:
    warnings.simplefilter("ignore", EquipoiseWarning)
    ur5 = eq.load(ROBOTS / "ur5.urdf")

    problem = Problem.of(ur5, span=2, radius=0.15)
    few, many = (build(replace(problem, samples=count)) for count in (1_000, 100_000))
    first, second = seconds(lambda: least_rms(few), lambda: least_rms(many))
    line("convex solve, UR5 span 2, 11 pairs", first, second, ("1,000 samples", "100,000 samples"))

    exact = build(problem)
    first, second = seconds(lambda: least_rms(exact), by_cvxpy(exact), repeat=3)
    line("convex solve, UR5 span 2, 11 pairs", first, second, ("direct", "through cvxpy"))

    first, second = seconds(lambda: build(problem), lambda: build(replace(problem, samples=4096)), repeat=3)
    line("compressing the problem", first, second, ("exact averages", "4,096 samples"))

    q = np.random.default_rng(0).uniform(-np.pi, np.pi, (4096, 6))
    potential, series = Potential(ur5), FourierEnergy(ur5)
    first, second = seconds(lambda: potential(q), lambda: [potential(x) for x in q[:128]])
    line("energy and torque of one UR5 pose", first / 4096, second / 128, ("4,096 at once", "one by one"))
    first, second = seconds(lambda: FourierEnergy(ur5), lambda: series.torque(q))
    line("UR5 Fourier form", first, second, ("proof", "4,096 torques from it"))


if __name__ == "__main__":
    main()
