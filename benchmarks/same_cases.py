"""What `same.py` asks both versions: every example by every command that judges it, and designs by every method.

Designs go to `made/`. What judges a stored design reads the one that the version before has made.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Set
from dataclasses import dataclass
from typing import Literal

QUICK = ("pendulum", "lee2014_table5a", "bevel_shoulder", "lin2010_arm", "four_bar", "ur5")
"""The examples of the quick subset: one of each kind, none slow."""
LOADED = {"pendulum": "arm", "ur5": "wrist_3_link"}  # bodies that a payload is put on

# The convex method in about a second to a minute each: few springs, and few poses where loops leave no exact averages
CONVEX = {
    "ur5": "--span 2 --radius 150mm --springs 3",
    "ur10": "--span 2 --radius 200mm --springs 3",
    "panda": "--span 2 --radius 150mm --springs 2",
    "xarm7": "--span 2 --radius 150mm --springs 2",
    "human": "--span 1 --radius 150mm --springs 2",
    "hexapod": "--span 2 --springs 2 --samples 256",
    "delta": "--span 2 --springs 2 --samples 256",
    "rssr": "--span 2 --springs 2 --samples 256",
    "desk_lamp": "--span 2 --springs 2 --samples 256",
    "lin2010_arm": "--span 2 --springs 3",
}
LARGE = ("human", "delta", "hexapod", "lin2010_rssr")  # hardware takes minutes for their designs
FEW = "--span 2 --springs 2"
TWIN = {"delta_balanced", "bevel_balanced", "lin2010_balanced", "lin2010_rssr"}  # designs of examples that stand beside

# The options of `design`, each once
OPTIONS = {
    "front": "design ur5.urdf --span 3 --radius 150mm --box --springs 3 --front",
    "peak": "design ur5.urdf --span 1 --radius 150mm --springs 1 --objective peak --samples 256",
    "joints": "design panda.urdf --span 3 --radius 150mm --springs 1 --joints panda_joint2,panda_joint4 --unlimited",
    "region": "design ur5.urdf --pairs base_link:forearm_link --region forearm_link=100mm --springs 1",
    "free-length": "design pendulum.yaml --springs 1 --free-length 50mm",
    "clearance": "design pendulum.yaml --springs 1 --clearance 1mm",
    "infeasible": "design ur5.urdf --span 1 --radius 150mm --springs 1 --exact",
    "layout": "design lee2014_table5a.yaml --method planar --set layout=13,14,24",
    "ground": "design lin2010_arm.yaml --method no-auxiliary --set layout=ground",
    "payload": "design bevel_shoulder.yaml --method bevel --set payload=0,1",
    "real": "design lee_chen_arm.yaml --method pseudobase --set real=yes",
    "approximate": "design delta.yaml --method delta --set variant=optimum",
}
QUICK_OPTIONS = {"front", "free-length", "payload"}
PAPERS = ("cho2012", "lee2014", "lenzo2017", "lin2010", "simionescu2015")


Rule = Literal["values", "design", "simulate", "text"]


@dataclass(frozen=True)
class Case:
    """A command and the rule that its answers are compared by; `reads` is the stored design that it judges."""

    rule: Rule
    argv: tuple[str, ...]
    reads: str | None = None


def evaluations(examples: list[str], quick: bool) -> Iterator[Case]:
    """What the examples are, without designing anything; `methods` also says what can be designed."""
    for file in examples:
        yield _case("values", f"methods {file} --json")
        yield _case("values", f"check {file} --json")
        yield _case("text", f"export {file} --to mjcf")
        yield _case("text", f"export {file} --to yaml")
        if not quick:
            yield _case("values", f"clearance {file} --samples 256 --json")
            yield _case("simulate", f"simulate {file} --seconds 1 --poses 2 --radius 50mm --json")
            yield _case("text", f"export {file} --to urdf")
    for name, body in LOADED.items():
        file = next(file for file in examples if _stem(file) == name)
        yield _case("values", f"check {file} --payload 0,1kg --payload-on {body} --payload-at 0,0.1,0.1 --json")
    yield _case("values", "layouts 4 --excluded --json")
    yield _case("values", "layouts 4 --objective span --json")
    if not quick:
        yield _case("values", "layouts 5 --json")
        yield from (_case("values", f"reproduce {paper} --json") for paper in PAPERS)
    else:
        yield from (_case("values", f"reproduce {paper} --json") for paper in PAPERS[:3])


def designs(applies: Mapping[str, Set[str]], quick: bool) -> Iterator[Case]:
    """Every method on every example that it applies to, and the options."""
    for file, methods in applies.items():
        name = _stem(file)
        for method in sorted(methods):
            if method == "convex" and name in TWIN:
                continue
            options = CONVEX.get(name, FEW) if method == "convex" else f"--method {method}"
            yield _case("design", f"design {file} {options} --json -o made/{method}-{name}.yaml")
    for name, text in OPTIONS.items():
        if name in QUICK_OPTIONS or not quick:
            yield _case("design", f"{text} --json -o made/{name}.yaml")


def judgements(made: list[str], quick: bool) -> Iterator[Case]:
    """What is said of stored designs."""
    for file in made:
        few = file in ("made/front.yaml", "made/bevel-bevel_shoulder.yaml", "made/convex-pendulum.yaml")
        large = _stem(file).endswith(LARGE)
        commands: dict[Rule, list[str]] = {
            "values": [f"check {file} --json"] + ([f"hardware {file} --json"] if few or not (quick or large) else []),
            "simulate": [] if quick and not few else [f"simulate {file} --seconds 1 --poses 2 --radius 50mm --json"],
            "text": [f"export {file} --to mjcf"],
        }
        if few:
            commands["values"] += [
                f"tolerance {file} --builds 1000 --poses 100 --json",
                f"clearance {file} --samples 256 --json",
            ]
        if file == "made/convex-ur5.yaml":
            commands["design"] = [f"design {file} --span 1 --radius 150mm --springs 1 --keep --json"]
        if file == "made/convex-pendulum.yaml":
            commands["values"].append(f"adjust {file} --payload 0,1kg --payload-on arm --payload-at 0.6,0,0 --json")
        for rule, texts in commands.items():
            yield from (Case(rule, tuple(text.split()), file) for text in texts)


def _case(rule: Rule, text: str) -> Case:
    return Case(rule, tuple(text.split()))


def _stem(file: str) -> str:
    return file.rpartition(".")[0]
