"""Is a version slower? `python benchmarks/alternate.py OLD NEW`: `run.py` of two checkouts by turns, five times each.

Compares the medians of what `run.py` prints, ratios and times, and names what is worse by more than 10 %: exit code 1.
What other programs take and what the machine allows is left out. Needs a quiet machine, and minutes for each turn.
"""

from __future__ import annotations

import argparse
import os
import re
import statistics
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

WORSE = 0.1
OTHERS = ("Pinocchio", "MuJoCo", "C for", "through cvxpy", "arithmetic", "memory")


class Figure(NamedTuple):
    """A number that was printed, and whether more of it is better."""

    name: str
    value: float
    more_is_better: bool


def figures(text: str) -> Iterator[Figure]:
    """The numbers in the tables and lines of `run.py`."""
    above, head = "", []
    for line in text.splitlines():
        if line.startswith("|"):
            cells = [cell.strip() for cell in line.strip("|").split("|")]
            if not head:
                head = cells
            elif set(cells) != {"---"} and not cells[0].startswith(OTHERS):
                aim = cells[head.index("aim")] if "aim" in head else ""
                more = aim.startswith("at least") if aim else "million poses per second" in " ".join(above.split())
                for title, cell in zip(head[1:], cells[1:], strict=True):
                    if cell and title != "aim":
                        name = ", ".join(part for part in (cells[0], head[0], title) if part)
                        yield Figure(name, float(cell.replace(",", "")), more)
            continue
        above, head = line or above, []
        if found := re.match(r"Streamed statistics of (\S+) .*?: (\S+) million per second", line):
            yield Figure(f"streamed statistics of {found[1]} poses, million per second", float(found[2]), True)
        elif found := re.match(r"(.*): (.+?) (\S+) ms, (.+?) (\S+) ms, ratio (\S+)", line):
            yield Figure(f"{found[1]}, {found[4]} / {found[2]}", float(found[6]), found[4] != "100,000 samples")
            for name, value in ((found[2], found[3]), (found[4], found[5])):
                if name not in OTHERS:
                    yield Figure(f"{found[1]}, {name}, ms", float(value), False)
        elif found := re.match(r"(.*): (\S+) ms for an update of the viewer", line):
            yield Figure(f"{found[1]}, update of the viewer, ms", float(found[2]), False)


def once(checkout: Path, python: str, streamed: str) -> list[Figure]:
    environment = os.environ | {"PYTHONPATH": str((checkout / "src").resolve())}
    command = [python, "benchmarks/run.py", "--stream", streamed]
    done = subprocess.run(command, cwd=checkout, env=environment, stdout=subprocess.PIPE, text=True, check=True)
    return list(figures(done.stdout))


def main() -> None:
    parser = argparse.ArgumentParser(description="Is NEW slower than OLD?")
    parser.add_argument("old", type=Path, help="checkout of the version before")
    parser.add_argument("new", type=Path, help="checkout of the version after")
    parser.add_argument("--python", default=sys.executable, help="interpreter with the dependencies (default: this)")
    parser.add_argument("--runs", type=int, default=5, help="of each")
    parser.add_argument("--stream", default="1e7", help="poses in the stream")
    args = parser.parse_args()
    values: dict[Path, dict[str, list[float]]] = {args.old: {}, args.new: {}}
    better: dict[str, bool] = {}
    for run in range(args.runs):
        for checkout in (args.old, args.new) if run % 2 == 0 else (args.new, args.old):
            print(f"run {run + 1} of {args.runs}: {checkout}", file=sys.stderr)
            for name, value, more in once(checkout, args.python, args.stream):
                values[checkout].setdefault(name, []).append(value)
                better[name] = more
    worse = []
    print(f"{'before':>9} {'after':>9}  change, medians of {args.runs}")
    for name, more in better.items():
        if name not in values[args.old] or name not in values[args.new]:
            print(f"{'only ' + ('after' if name in values[args.new] else 'before'):>19}  {'':8}  {name}")
            continue
        before, after = (statistics.median(values[checkout][name]) for checkout in (args.old, args.new))
        loss = before / after - 1 if more else after / before - 1
        print(f"{before:9.3g} {after:9.3g}  {100 * (after / before - 1):+6.1f} %  {name}{'  WORSE' * (loss > WORSE)}")
        worse += [name] if loss > WORSE else []
    print(f"{len(worse)} of {len(better)} worse by more than {100 * WORSE:g} %")
    sys.exit(1 if worse else 0)


if __name__ == "__main__":
    main()
