"""Does a version say what another says? `python benchmarks/same.py OLD NEW`: two checkouts, all examples.

    python benchmarks/same.py ../before . --store before.json            # everything
    python benchmarks/same.py ../before . --store before.json --quick    # a part: 45 s of the processor a side

Evaluations agree to 1e-9 of their scale; designs have the same verdict, pairs and number of springs, and bound and
residual to 1e-6 of the unbalanced torque; simulations have the same verdict. Each side runs in one process with its own
`src` first on the path. `--store` keeps what OLD says, so that the next time only NEW runs. Exit code 1 names what
differs. New keys are listed and allowed, and so is changed prose.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import os
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from same_cases import QUICK, Case, designs, evaluations, judgements
from same_values import compare

Answer = dict[str, Any]


class Side:
    """One version, running: give it a command, get what it says."""

    def __init__(self, checkout: Path, python: str, folder: Path) -> None:
        self.source = (checkout / "src").resolve()
        environment = os.environ | {"PYTHONPATH": str(self.source), "COLUMNS": "200", "OPENBLAS_NUM_THREADS": "1"}
        command = [python, str(Path(__file__).parent.resolve() / "same_side.py")]
        pipe = subprocess.PIPE
        self.process = subprocess.Popen(command, stdin=pipe, stdout=pipe, text=True, env=environment, cwd=folder)
        loaded = Path(self._read())
        if not loaded.is_relative_to(self.source):
            raise SystemExit(f"asked for {self.source}, but {loaded} was imported")

    def run(self, case: Case, stored: str | None) -> Answer:
        files = {} if case.reads is None else {case.reads: stored}
        assert self.process.stdin is not None
        self.process.stdin.write(json.dumps({"argv": case.argv, "files": files}) + "\n")
        self.process.stdin.flush()
        return self._read()

    def _read(self) -> Any:
        assert self.process.stdout is not None
        line = self.process.stdout.readline()
        if not line:
            raise SystemExit(f"the process of {self.source} ended with code {self.process.wait()}")
        return json.loads(line)

    def close(self) -> None:
        self.process.stdin.close()  # pyright: ignore[reportOptionalMemberAccess]
        self.process.wait()


class Before:
    """The version that is compared with: it runs only what the store does not have."""

    def __init__(self, checkout: Path, python: str, folder: Path, store: Path | None) -> None:
        self.make = lambda: Side(checkout, python, folder)
        self.side: Side | None = None
        self.store, self.seconds = store, 0.0
        self.state = _state(checkout)
        self.answers: dict[str, Answer] = {}
        if store is not None and store.exists():
            kept = json.loads(store.read_text())
            if kept["state"] != self.state:
                raise SystemExit(f"{store} is of another version than {checkout}: remove it, or give another file")
            self.answers = kept["answers"]

    def ask(self, case: Case) -> Answer:
        key = " ".join(case.argv)
        if key not in self.answers:
            self.side = self.side or self.make()
            self.answers[key] = self.side.run(case, self.made(case.reads))
            self.seconds += self.answers[key]["seconds"]
            print(f"{'before':8} {self.answers[key]['seconds']:6.1f} s  {key}", flush=True)
        return self.answers[key]

    def made(self, file: str | None) -> str | None:
        """The stored design of this name."""
        return next((a["made"] for key, a in self.answers.items() if file and key.endswith(f"-o {file}")), None)

    def close(self) -> None:
        if self.side is not None:
            self.side.close()
        if self.store is not None:
            self.store.write_text(json.dumps({"state": self.state, "answers": self.answers}))


def _state(checkout: Path) -> str:
    """Of the sources and examples."""
    files = sorted([*checkout.glob("src/**/*.py"), *checkout.glob("examples/*/*")])
    digest = hashlib.sha256()
    for file in files:
        digest.update(str(file.relative_to(checkout)).encode() + file.read_bytes())
    return digest.hexdigest()


def _examples(checkout: Path, quick: bool) -> dict[str, str]:
    paths = [*checkout.glob("examples/mechanisms/*.yaml"), *checkout.glob("examples/robots/*.urdf")]
    return {path.name: path.read_text() for path in sorted(paths) if path.stem in QUICK or not quick}


def ask_all(before: Before, examples: Iterable[str], quick: bool) -> list[Case]:
    """The commands, all answered by the version before, which also says what can be designed."""
    cases = list(evaluations(list(examples), quick))
    for case in cases:
        before.ask(case)
    rows = {c.argv[1]: json.loads(before.ask(c)["out"]) for c in cases if c.argv[0] == "methods"}
    applies = {file: {row["method"] for row in methods if row["applies"]} for file, methods in rows.items()}
    new = list(designs(applies, quick))
    for case in new:
        before.ask(case)
    made = [case.argv[-1] for case in new if before.ask(case)["made"] is not None]
    judged = list(judgements(made, quick))
    for case in judged:
        before.ask(case)
    return [*cases, *new, *judged]


def main() -> None:
    parser = argparse.ArgumentParser(description="Does NEW say what OLD says?")
    parser.add_argument("old", type=Path, help="checkout of the version before")
    parser.add_argument("new", type=Path, help="checkout of the version after")
    parser.add_argument("--python", default=sys.executable, help="interpreter with the dependencies (default: this)")
    parser.add_argument("--store", type=Path, help="file that keeps what OLD says")
    parser.add_argument("--quick", action="store_true", help="a subset")
    parser.add_argument("--only", default="", metavar="TEXT", help="commands that contain this text")
    args = parser.parse_args()
    start = time.perf_counter()
    examples = _examples(args.old, args.quick)
    with tempfile.TemporaryDirectory() as name:
        folders = [Path(name) / side for side in ("before", "after")]
        for folder in folders:
            (folder / "made").mkdir(parents=True)
            for file, text in examples.items():
                (folder / file).write_text(text)
        before = Before(args.old, args.python, folders[0], args.store)
        try:
            cases = ask_all(before, examples, args.quick)
        finally:
            before.close()
        after = Side(args.new, args.python, folders[1])
        different, new, codes, seconds = [], set(), Counter(), 0.0
        for case in cases:
            key = " ".join(case.argv)
            if args.only not in key:
                continue
            expected, answer = before.ask(case), after.run(case, before.made(case.reads))
            found = compare(case.rule, expected, answer)
            seconds += answer["seconds"]
            codes[expected["code"]] += 1
            print(f"{'DIFFERS' if found.differences else 'same':8} {answer['seconds']:6.1f} s  {key}", flush=True)
            for line in found.differences[:5] + [f"(noted) {note}" for note in found.notes[:2]]:
                print(f"                   {line}")
            different += [key] if found.differences else []
            new |= {f"{case.argv[0]}: {key}" for key in found.new}
        after.close()
    print(
        f"\n{sum(codes.values())} commands: {codes[0]} good, {codes[1]} with the answer no, {codes[2]} refused", end=""
    )
    print(f"; {time.perf_counter() - start:.0f} s in all: before {before.seconds:.0f} s, after {seconds:.0f} s")
    for key in sorted(new):
        print(f"new key  {key}")
    for key in different:
        print(f"DIFFERS  {key}")
    print(f"{len(different)} differ" if different else "nothing differs")
    sys.exit(1 if different else 0)


if __name__ == "__main__":
    main()
