"""Fuzzing of one reader for a time: python tests/fuzz.py READER SECONDS [SEED].

With atheris, which needs Linux, mutations follow the coverage of the readers; without it examples are mutated at
random. What is not refused with an error of ours, or takes too long, ends the script with its bytes and a traceback.
"""

from __future__ import annotations

import contextlib
import random
import sys
import tempfile
import time
import warnings
from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[1]
EXAMPLES = ROOT / "examples"
SLOWEST = 5  # [s] for one input
LONGEST = 4096  # bytes of an input
SEEDS = {
    "yaml": [*(EXAMPLES / "mechanisms").glob("*.yaml"), *(ROOT / "tests" / "bad_inputs").glob("*.yaml")],
    "urdf": [*(EXAMPLES / "robots").glob("*.urdf")],
    "motion": [],
    "list": [],
    "quantity": [],
    "sniffed": [*(EXAMPLES / "robots").glob("*.urdf")],
}
TEXTS = {
    "yaml": [
        b"""schema: 1
name: a
bodies: [{name: b, mass: 850 g, com: [0, 0, 1e-3]}]
joints:
  - {name: j, type: revolute, parent: world, child: b, axis: [0, 1, 0], range: [-35 deg, 1]}
springs: [{name: s, body_a: world, p_a: [0, 0, 1], body_b: b, p_b: [1, 0, 0], stiffness: 20 kN/m}]
"""
    ],
    "urdf": [
        b"""<robot name="r"><link name="a"/><link name="b"><inertial><mass value="1"/>
<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link><joint name="j" type="revolute">
<parent link="a"/><child link="b"/><axis xyz="0 0 1"/><limit lower="-1" upper="1"/><mimic joint="k"/></joint></robot>"""
    ],
    "motion": [b"time,shoulder [deg]\n0,0\n1,10\n2,0\n"],
    "list": [
        b"""part,kind,rate [N/mm],max_force,free_length,outer_diameter,wire_diameter,mass
p,extension,1,9,1,.1,.01,1
"""
    ],
    "quantity": [b"20 kN/m", b"35 deg", b"850 g", b"-1.5e3 kg*m^2", b"1 m**2/s"],
    "sniffed": [b"<!-- c --><mujoco/>", b"<?xml version='1.0'?><robot name='r'/>"],
}
READERS = tuple(SEEDS)


def reader(name: str, folder: Path) -> Callable[[bytes], None]:
    """What reads the bytes of one input, and lets through what should not be raised."""
    import equipoise as eq
    from equipoise import io
    from equipoise.cli import motions
    from equipoise.hardware import read_catalogue
    from equipoise.kinematics import Tree
    from equipoise.model.errors import EquipoiseWarning, InputError
    from equipoise.model.units import SI_UNITS, to_si

    warnings.simplefilter("error")
    warnings.simplefilter("ignore", EquipoiseWarning)
    suffix = {"yaml": ".yaml", "urdf": ".urdf", "sniffed": ".xml"}.get(name, ".csv")
    path = folder / f"input{suffix}"
    tree = Tree.of(eq.load(EXAMPLES / "mechanisms" / "pendulum.yaml"))

    def read(data: bytes) -> None:
        path.write_bytes(data)
        with contextlib.suppress(InputError):
            match name:
                case "motion":
                    motions.named(str(path), tree)
                case "list":
                    read_catalogue(path)
                case "quantity":
                    for dimension in SI_UNITS:
                        with contextlib.suppress(InputError):
                            to_si(data.decode(errors="replace"), dimension)
                case "sniffed" if b"<mujoco" in data:
                    io.models._is_mjcf(path)  # compiling takes a process; the campaign of models does that
                case _:
                    eq.load(path)

    return read


def main(name: str, seconds: float, seed: int = 0) -> int:
    seeds = [*TEXTS[name], *(path.read_bytes()[:LONGEST] for path in SEEDS[name])]
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        try:
            atheris: Any = import_module("atheris")
        except ImportError:
            return at_random(reader(name, folder), seeds, seconds, seed)
        with atheris.instrument_imports(
            include=["equipoise.io", "equipoise.model", "equipoise.cli.motions", "equipoise.hardware"]
        ):
            read = reader(name, folder)
        corpus = folder / "corpus"
        corpus.mkdir()
        for number, data in enumerate(seeds):
            (corpus / str(number)).write_bytes(data)
        limits = [f"-max_total_time={seconds:.0f}", f"-timeout={SLOWEST}", f"-max_len={LONGEST}", "-rss_limit_mb=1000"]
        atheris.Setup(
            ["fuzz", *limits, f"-seed={seed + 1}", f"-artifact_prefix={tempfile.gettempdir()}/", str(corpus)], read
        )
        atheris.Fuzz()
    return 0


def at_random(read: Callable[[bytes], None], seeds: list[bytes], seconds: float, seed: int) -> int:
    """Cut, repeat, exchange and overwrite pieces of the examples, and of what has been made of them."""
    rng, end, count = random.Random(seed), time.monotonic() + seconds, 0
    odd = [
        b"\0",
        b"\xff",
        b"nan",
        b"1e999",
        b"-0",
        b"[",
        b"]",
        b"{",
        b'"',
        b"'",
        b"<",
        b">",
        b"&#0;",
        b"\n",
        b": ",
        b"- ",
        b"\t",
    ]
    odd += [b"9" * 40, b"1e308", b"1e-308", b"a" * 300, b"*a", b"&a ", b"!!x ", b"#", b"%", b",", b"--- "]
    pool = list(seeds)
    while time.monotonic() < end:
        data = bytearray(rng.choice(pool))
        for _ in range(rng.randint(1, 4)):
            at, to = sorted(rng.randint(0, len(data)) for _ in range(2))
            other = rng.choice(pool)
            start = rng.randint(0, len(other))
            piece = (b"", bytes(data[at:to]) * 2, rng.choice(odd), other[start : start + rng.randint(0, 200)])
            data[at : rng.choice((at, min(to, at + 40)))] = rng.choice(piece)
        data, begun, count = data[:LONGEST], time.monotonic(), count + 1
        try:
            read(bytes(data))
        except Exception:
            print(f"input {count}: {bytes(data)!r}", file=sys.stderr)
            raise
        if (took := time.monotonic() - begun) > SLOWEST:
            print(f"input {count} took {took:.1f} s: {bytes(data)!r}", file=sys.stderr)
            return 1
        if rng.random() < 0.01:
            pool[len(seeds) :] = [*pool[len(seeds) :][-200:], bytes(data)]
    print(f"{count} inputs")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1], float(sys.argv[2]), *map(int, sys.argv[3:])))
