"""`make bench`: speed of the kernel beside its peers, and of the solvers. Add `--write` to renew docs/speed.md.

Times depend on the machine, the ratios much less.
"""

from __future__ import annotations

import sys
from pathlib import Path

import measure
import solving
import speed
import viewing

DOCS = Path(__file__).parents[1] / "docs"


def table(head: tuple[str, ...], rows: list[tuple[str, ...]]) -> str:
    lines = [head, ("---",) * len(head), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def report(streamed: int) -> tuple[str, dict[str, list[tuple[int, float]]]]:
    """The page, and how the time grows."""
    speed.sanity()
    rates = speed.rates()
    million = {(rate.name, rate.threads): rate.million for rate in rates}
    names = list(dict.fromkeys(rate.name for rate in rates))
    found = [(name, *(f"{million[name, t]:.3g}" if (name, t) in million else "" for t in (1, 2))) for name in names]
    growth = speed.growth()
    seconds, compiler, memory = speed.streaming(streamed)
    ratios = []
    for name, aim in ((speed.PINOCCHIO, "30"), (speed.MUJOCO, "100"), (speed.C, "0.5")):
        if (name, 1) in million:
            shares = (f"{million[speed.GENERATED, t] / million[name, t]:.3g}" for t in (1, 2))
            ratios.append((f"generated kernel / {name}", *shares, f"at least {aim}"))
    both = million[speed.GENERATED, 2] / million[speed.GENERATED, 1]
    ratios.append(("two threads / one", "", f"{both:.3g}", "at least 1.7"))
    steep = f"{speed.slope(growth['joints']):.3g}"
    ratios.append(("growth with joints, slope of the logarithms", steep, "", "at most 1.15"))
    parts = [
        f"UR5 with five zero-free-length springs, energy and torque, {speed.POSES:,} poses, in million poses per "
        f"second, on {measure.machine()}:\n",
        table(("", "1 thread", "2 threads"), found),
        "\nRatios in the same run, and what is aimed at:\n",
        table(("", "1 thread", "2 threads", "aim"), ratios),
        "\nWhat one core allows, million poses per second:\n",
        table(("limit", "estimate"), [(name, f"{value:.3g}") for name, value in speed.limits()]),
        "\nNanoseconds per pose on one core:\n",
        *(
            table((what, *(f"{n:,}" for n, _ in points)), [("ns", *(f"{t:.3g}" for _, t in points))]) + "\n"
            for what, points in growth.items()
        ),
        f"Streamed statistics of {streamed:,} random poses on two threads: {streamed / seconds / 1e6:.3g} million per "
        f"second, drawing them included; {memory:.3g} MiB of memory, after the compiler's {compiler:.3g}.\n",
        table(("starting", "s"), [(what, f"{value:.3g}") for what, value in speed.starting()]),
        "\nSolvers, once warm:\n",
        table(("", "ms"), [(what, f"{1e3 * value:.3g}") for what, value in solving.warm()]),
        "",
        table(("", "s"), [(what, f"{value:.3g}") for what, value in solving.long()]),
    ]
    return "\n".join(parts), growth


def picture(rates: dict[str, list[tuple[int, float]]], path: Path) -> None:
    """Time per pose over joints, springs and configurations."""
    import matplotlib

    matplotlib.use("svg")
    import matplotlib.pyplot as plt

    matplotlib.rcParams["svg.hashsalt"] = "equipoise"
    figure, axes = plt.subplots(1, 3, figsize=(9, 3), layout="constrained", sharey=True)
    for ax, (what, points) in zip(axes, rates.items(), strict=True):
        x, y = zip(*points, strict=True)
        if what == "springs":
            ax.semilogy(x, y, "o-")
        else:
            ax.loglog(x, y, "o-")
        ax.set_xlabel(what)
        ax.grid(True, which="both", alpha=0.3)
    axes[0].set_ylabel("ns per pose, one core")
    figure.savefig(path, metadata={"Date": None})


def main() -> None:
    page, growth = report(int(float(sys.argv[sys.argv.index("--stream") + 1])) if "--stream" in sys.argv else 10**8)
    print(page)
    if "--write" in sys.argv:
        path = DOCS / "speed.md"
        text = path.read_text()
        mark = "<!-- measured -->\n"
        path.write_text(text[: text.index(mark) + len(mark)] + "\n" + page + "\n")
        picture(growth, DOCS / "images" / "speed.svg")
    solving.main()
    viewing.main()


if __name__ == "__main__":
    main()
