"""Hostile inputs by kind: what a file, a table or a name may hold that has once hung, flooded or broken a reader."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from io import BytesIO
from pathlib import Path
from typing import Any

Maker = Callable[[Path], None]


@dataclass(frozen=True)
class Case:
    """Files to make in a folder, and the command that reads them; `name` tells the kind."""

    name: str
    files: dict[str, str | bytes | Maker] = field(repr=False)
    command: tuple[str, ...]

    def make(self, folder: Path) -> list[str]:
        """Make the files, and give the command with their paths."""
        for name, content in self.files.items():
            path = folder / name
            if isinstance(content, bytes):
                path.write_bytes(content)
            elif isinstance(content, str):
                path.write_text(content, encoding="utf-8", newline="")
            else:
                content(path)
        return [str(folder / part) if part in self.files else part for part in self.command]


def check(name: str, file: str, content: str | bytes | Maker, **others: str | bytes | Maker) -> Case:
    return Case(name, {file: content, **others}, ("check", file))


TEXTS = {
    "letters that were gone through exponentially": "1 " + "a" * 40 + "!",
    "many letters": "1 " + "a" * 100_000,
    "many digits": "1" * 100_000 + "x",
    "digits and dots": "1." * 50_000,
    "signs": "+-" * 50_000,
    "brackets": "1 " + "(" * 5_000,
    "units times units": "1 " + "kg*" * 60 + "!",
    "powers": "1 m" + "^4" * 90,
    "spaces": "1" + " " * 100_000 + "!",
    "an expression": "1 __import__('os').system('true')",
    "infinity": "1e999",
    "no number": "nan",
}
"""What may stand for a quantity, each of them wrong everywhere."""

YAML = """\
schema: 1
name: arm
gravity: [0, 0, {gravity}]
bodies:
  - {{name: a, mass: {mass}, com: [{com}, 0, 0], inertia: [{inertia}, 1, 1, 0, 0, 0]}}
  - {{name: b, mass: 1}}
joints:
  - {{name: j, type: revolute, parent: world, child: a, xyz: [{xyz}, 0, 0], rpy: [{rpy}, 0, 0], axis: [0, {axis}, 0],
     range: [-1, {range}], damping: {damping}, friction: {friction}}}
  - {{name: k, type: prismatic, parent: a, child: b, axis: [0, 1, 0], range: [0, {slide}]}}
couplings: [{{joint: k, terms: {{j: {ratio}}}, offset: {offset}}}]
springs:
  - {{name: s, body_a: world, p_a: [0, 0, {point}], body_b: b, p_b: [1, 0, 0], stiffness: {stiffness},
     free_length: {free_length}, mass: {spring_mass}, diameter: {diameter}}}
masses: [{{name: m, body: b, mass: {load}, position: [{position}, 0, 0]}}]
capsules: [{{name: c, body: b, p_a: [0, 0, 0], p_b: [{capsule}, 0, 0], radius: {radius}}}]
"""
FIELDS = [
    "gravity", "mass", "com", "inertia", "xyz", "rpy", "axis", "range", "damping", "friction", "slide", "ratio",
    "offset", "point", "stiffness", "free_length", "spring_mass", "diameter", "load", "position", "capsule", "radius",
]  # fmt: skip
GOOD = dict.fromkeys(FIELDS, "1")

DH = """\
schema: 1
name: arm
bodies: [{{name: a, mass: 1}}]
dh:
  convention: standard
  rows: [{{a: {a}, alpha: {alpha}, d: {d}, theta: {theta}}}]
"""

URDF = """\
<robot name="r"><link name="world"/>
<link name="a"><inertial><origin xyz="{com} 0 0" rpy="0 0 0"/><mass value="{mass}"/>
<inertia ixx="{inertia}" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="j" type="revolute"><parent link="world"/><child link="a"/><origin xyz="{xyz} 0 0" rpy="{rpy} 0 0"/>
<axis xyz="0 {axis} 0"/><limit lower="-1" upper="{upper}"/><dynamics damping="{damping}" friction="{friction}"/></joint>
</robot>
"""
ATTRIBUTES = ["com", "mass", "inertia", "xyz", "rpy", "axis", "upper", "damping", "friction"]

MJCF = (
    '<mujoco>{before}<worldbody><body name="a"><joint name="j" axis="0 1 0"/><geom size=".1"/>{inside}</body>{beside}'
)
MJCF += "</worldbody>{after}</mujoco>"


def mjcf(before: str = "", inside: str = "", beside: str = "", after: str = "") -> str:
    return MJCF.format(before=before, inside=inside, beside=beside, after=after)


def quantities() -> Iterator[Case]:
    for what, text in TEXTS.items():
        for key in FIELDS:
            yield check(f"YAML {key}: {what}", "a.yaml", YAML.format(**GOOD | {key: f'"{text}"'}))
        for key in ("a", "alpha", "d", "theta"):
            good = dict.fromkeys(("a", "alpha", "d", "theta"), "1")
            yield check(f"DH {key}: {what}", "a.yaml", DH.format(**good | {key: f'"{text}"'}))
        for key in ATTRIBUTES:
            yield check(f"URDF {key}: {what}", "a.urdf", URDF.format(**dict.fromkeys(ATTRIBUTES, "1") | {key: text}))


def sizes() -> Iterator[Case]:
    """Numbers whose squares and products leave what a computer can hold: refused, or computed."""
    for size in ("1e308", "-1e308", "1e200", "1e-308", "5e-324", "1e160", "-1e-200"):
        for key in FIELDS:
            yield Case(
                f"YAML {key} of {size}", {"a.yaml": YAML.format(**GOOD | {key: size})}, ("check", "a.yaml", "--json")
            )
        for key in ATTRIBUTES:
            text = URDF.format(**dict.fromkeys(ATTRIBUTES, "1") | {key: size})
            yield Case(f"URDF {key} of {size}", {"a.urdf": text}, ("check", "a.urdf", "--json"))


def options() -> Iterator[Case]:
    arm = {"a.yaml": YAML.format(**GOOD)}
    text = TEXTS["letters that were gone through exponentially"]
    for name, command in {
        "tolerance": ("check", "a.yaml", "--tolerance", text),
        "payload": ("check", "a.yaml", "--payload", f"0,{text}", "--payload-on", "b"),
        "radius": ("design", "a.yaml", "--radius", text),
        "region": ("design", "a.yaml", "--region", f"a={text}"),
        "free length": ("design", "a.yaml", "--free-length", text),
        "samples": ("check", "a.yaml", "--samples", "1000000000"),
        "steps": ("check", "a.yaml", "--steps", "1000000000", "--payload", "0,1", "--payload-on", "b"),
        "poses": ("simulate", "a.yaml", "--poses", "1000000000", "--radius", "1"),
        "seconds": ("simulate", "a.yaml", "--seconds", "1e308", "--radius", "1"),
        "move": ("simulate", "a.yaml", "--move", "j:0:1e308:0:1"),
        "a short move": ("simulate", "a.yaml", "--move", "j:0:1e-308:0:1"),
        "builds": ("tolerance", "a.yaml", "--builds", "1000000000"),
        "builds and poses": ("tolerance", "a.yaml", "--builds", "1000000", "--poses", "1000000"),
        "links": ("layouts", "1000000000"),
        "many links": ("layouts", "8"),
        "layouts' springs": ("layouts", "4", "--springs", "5000"),
        "count": ("made-up", "--count", "1000000000", "-o", "list.csv"),
    }.items():
        yield Case(f"option {name}", {**arm, "list.csv": ""}, command)


def no_files() -> Iterator[Case]:
    def link(to: str) -> Maker:
        return lambda path: path.symlink_to(to)

    def linked(path: Path) -> None:
        os.mkfifo(path.with_suffix(".pipe"))
        path.symlink_to(path.with_suffix(".pipe"))

    makers: dict[str, Maker] = {
        "a pipe": lambda path: os.mkfifo(path),
        "a link to a pipe": lambda path: (
            os.mkfifo(path.with_suffix(".pipe")),
            path.symlink_to(path.with_suffix(".pipe")),
        )[1],
        "an endless device": link("/dev/zero"),
        "a device": link("/dev/urandom"),
        "an empty device": link(os.devnull),
        "a folder": lambda path: path.mkdir(),
        "a link to itself": lambda path: path.symlink_to(path),
        "a link to nothing": link("/nothing/at/all"),
    }
    arm = YAML.format(**GOOD)
    for what, make in makers.items():
        for file in ("a.yaml", "a.urdf", "a.xml", "a.mjcf"):
            yield check(f"{file} is {what}", file, make)
        yield Case(f"motion is {what}", {"a.yaml": arm, "m.csv": make}, ("simulate", "a.yaml", "--motion", "m.csv"))
        yield Case(f"list is {what}", {"a.yaml": arm, "l.csv": make}, ("stock", "a.yaml", "l.csv"))
        yield Case(f"Parquet is {what}", {"a.yaml": arm, "l.parquet": make}, ("stock", "a.yaml", "l.parquet"))
        yield Case(f"include is {what}", {"a.xml": mjcf('<include file="b.xml"/>'), "b.xml": make}, ("check", "a.xml"))
        model = "schema: 1\nname: a\nmodel: b.urdf\n"
        yield Case(f"model is {what}", {"a.yaml": model, "b.urdf": make}, ("check", "a.yaml"))


def contents() -> Iterator[Case]:
    for file in ("a.yaml", "a.urdf", "a.mjcf"):
        for what, content in {
            "empty": b"",
            "spaces": b" \n" * 1000,
            "zeros": b"\0" * 1000,
            "binary": bytes(range(256)),
            "UTF-16": "schema: 1".encode("utf-16"),
            "Latin-1": "schéma".encode("latin-1"),
            "a byte order mark": b"\xef\xbb\xbf",
            "half a character": b"schema: 1\xe2\x82",
            "21 MB": b"a" * 21_000_000,
            "1 MB of letters": b"a" * 1_000_000,
            "1 MB of lines": b"\n\n#" * 333_000,
            "brackets": b"[" * 100_000,
            "tags": b"<a>" * 100_000,
            "quotes": b'"' * 100_001,
            "carriage returns": b"\r" * 10_000,
            "escapes": b"\x1b[31m" * 100,
        }.items():
            yield check(f"{file}: {what}", file, content)


def yaml_structure() -> Iterator[Case]:
    head = "schema: 1\nname: arm\n"
    body = "  - {{name: b{0}, mass: 1}}\n"
    for what, text in {
        "aliases": "a: &a [1, 1]\nb: &b [*a, *a]\nc: [*b, *b]\n",
        "a tag": head + "bodies: !!python/object/apply:os.system ['true']\n",
        "two documents": head + "---\n" + head,
        "deep lists": head + "provenance: " + "[" * 1000 + "]" * 1000,
        "deep mappings": head + "provenance: " + "{a: " * 1000 + "}" * 1000,
        "a key of a megabyte": "a" * 900_000 + ": 1\n",
        "a thousand unknown keys": head + "".join(f"k{i}: 1\n" for i in range(1000)),
        "ten thousand unknown keys": head + "".join(f"k{i}: 1\n" for i in range(10_000)),
        "the same key a thousand times": head + "bodies: []\n" * 1000,
        "ten thousand faulty bodies": head + "bodies:\n" + "  - {nam: b, mas: x}\n" * 5000,
        "ten thousand bodies": head + "bodies:\n" + "".join(map(body.format, range(10_000))),
        "a thousand bodies": head + "bodies:\n" + "".join(map(body.format, range(1000))),
        "a thousand springs": head
        + "springs:\n"
        + "".join(
            f"  - {{name: s{i}, body_a: world, p_a: [0,0,0], body_b: b, p_b: [0,0,0], stiffness: 1}}\n"
            for i in range(1000)
        ),
        "hundreds of unknown names": head
        + "bodies:\n"
        + "".join(map(body.format, range(300)))
        + "joints:\n"
        + "".join(f"  - {{name: j{i}, type: fixed, parent: bb{i}, child: bc{i}}}\n" for i in range(300)),
        "a ring of joints": head
        + "bodies: [{name: a}, {name: b}]\njoints:\n  - {name: j, type: fixed, parent: a, child: b}\n"
        "  - {name: k, type: fixed, parent: b, child: a}\n",
        "dates for numbers": head + "gravity: [2020-01-01, 0, 0]\n",
        "whole numbers of a thousand digits": head + f"gravity: [{'9' * 1000}, 0, 0]\n",
        "whole numbers of ten thousand digits": head + f"gravity: [{'9' * 10_000}, 0, 0]\n",
        "a hexadecimal number of ten thousand digits": head + f"gravity: [0x{'f' * 10_000}, 0, 0]\n",
        "samples of 1e9": head + "workspace: {samples: 1e9}\n",
        "samples of 1e400": head + "workspace: {samples: 1e400}\n",
        "an escape beyond Unicode": head + 'provenance: {a: "\\UFFFFFFFF"}\n',
        "a model that is itself": head + "model: a.yaml\n",
        "a model above": head + "model: ../../../../etc/passwd\n",
        "a model with a NUL": head + 'model: "a\\0.urdf"\n',
        "a list instead": "- 1\n",
        "a text instead": "hello\n",
        "a wrong schema": "schema: 99\nname: a\n",
    }.items():
        yield check(f"YAML: {what}", "a.yaml", text)


def controls() -> Iterator[Case]:
    """Names that a terminal would obey; in files, in their names and in what is quoted of them."""
    for what, letter in {
        "escape": "\x1b",
        "CSI": "\x9b",
        "bell": "\x07",
        "line separator": "\u2028",
        "newline": "\n",
    }.items():
        written = letter.encode("unicode_escape").decode().replace("\\x", "\\u00")
        name = f"{written}[31mred"
        yield check(f"YAML name with {what}", "a.yaml", f'schema: 1\nname: "{name}"\n')
        yield check(f"YAML body with {what}", "a.yaml", f'schema: 1\nname: a\nbodies: [{{name: "{name}"}}]\n')
        yield check(f"YAML key with {what}", "a.yaml", f'schema: 1\nname: a\n"{name}": 1\n')
        yield check(
            f"YAML reference with {what}", "a.yaml", YAML.format(**GOOD).replace("body: b", f'body: "{name}"', 1)
        )
        file = f"{letter}[31mred.yaml"
        yield check(f"file name with {what}", file, "schema: 2\nname: a\n")
        arm = {"a.yaml": YAML.format(**GOOD)}
        row = f"{letter}[31mred,extension,1,1,1,1,1,1\n"
        head = "part,kind,rate,max_force,free_length,outer_diameter,wire_diameter,mass\n"
        if not letter.isspace():  # a row that begins on the next line is a list like any other
            yield Case(f"part with {what}", {**arm, "l.csv": head + row}, ("stock", "a.yaml", "l.csv"))
        yield Case(
            f"heading with {what}",
            {**arm, "m.csv": f"time,{letter}[31m\n"},
            ("simulate", "a.yaml", "--motion", "m.csv"),
        )
    for what, text in {"escape": "\x1b", "C1": "&#x9b;", "direction": "\u202e"}.items():
        yield check(
            f"URDF with {what}", "a.urdf", f'<robot name="r"><link name="a"/><joint name="{text}[31m"/></robot>'
        )


def xml() -> Iterator[Case]:
    link = "<link name='l{0}'/>"
    joint = "<joint name='j{0}' type='{1}'><parent link='l{0}'/><child link='l{2}'/></joint>"
    for what, text in {
        "entities": '<!DOCTYPE r [<!ENTITY a "aa"><!ENTITY b "&a;&a;">]><robot name="&b;"/>',
        "an outside entity": '<!DOCTYPE r SYSTEM "http://127.0.0.1:1/x"><robot name="a"/>',
        "ten thousand faulty joints": "<robot name='r'>" + "<joint/>" * 10_000 + "</robot>",
        "a hundred thousand elements": "<robot name='r'>" + "<x/>" * 100_000 + "</robot>",
        "deep elements": "<robot name='r'>" + "<x>" * 20_000 + "</x>" * 20_000 + "</robot>",
        "many attributes": "<robot name='r' " + " ".join(f"a{i}='1'" for i in range(50_000)) + "/>",
        "the same attribute": "<robot name='r' name='s'/>",
        "a name of a megabyte": f"<robot name='r'><link name='{'a' * 1_000_000}'/><joint name='j'/></robot>",
        "a thousand links": "<robot name='r'><link name='l0'/>"
        + "".join(link.format(i + 1) + joint.format(i, "fixed", i + 1) for i in range(1000))
        + "</robot>",
        "ten thousand turning links": "<robot name='r'><link name='l0'/>"
        + "".join(link.format(i + 1) + joint.format(i, "continuous", i + 1) for i in range(10_000))
        + "</robot>",
        "a ring": "<robot name='r'><link name='l0'/><link name='l1'/>"
        + joint.format(0, "fixed", 1)
        + "<joint name='k' type='fixed'><parent link='l1'/><child link='l0'/></joint></robot>",
        "a comment without end": "<!--" + "-" * 100_000,
        "comments that only begin": "<!--" * 200_000,
        "comments": "<!-- -->" * 20_000 + "<robot",
        "instructions": "<?x ?>" * 20_000 + "<robot",
        "an unknown encoding": '<?xml version="1.0" encoding="klingon"?><robot',
        "no robot": "<sdf version='1.7'/>",
    }.items():
        yield check(f"URDF: {what}", "a.urdf", text)
        yield check(f"XML: {what}", "a.xml", text)


def models() -> Iterator[Case]:
    many = '<replicate count="1000" offset="1 0 0">' * 3 + '<body><joint/><geom size=".1"/></body>' + "</replicate>" * 3
    fixed = '<tendon><fixed name="t"><joint joint="j" coef="{}"/></fixed></tendon>'
    fixed += '<equality><tendon tendon1="t"/></equality>'
    for what, text in {
        "copies of copies": mjcf(beside=many),
        "a thousand bodies": mjcf(beside='<body><joint/><geom size=".1"/></body>' * 1000),
        "a height field of gigabytes": mjcf(
            '<asset><hfield name="h" nrow="20000" ncol="20000" size="1 1 1 1"/></asset>',
            beside='<geom type="hfield" hfield="h"/>',
        ),
        "a texture of gigabytes": mjcf(
            '<asset><texture name="t" type="2d" builtin="flat" width="60000" height="60000"/></asset>'
        ),
        "memory of gigabytes": mjcf('<size memory="900G"/>'),
        "a grid": mjcf(beside='<flexcomp name="f" type="grid" count="80 80 80" spacing="1 1 1" dim="3"/>'),
        "a tendon of NaN": mjcf(after=fixed.format("nan")),
        "an unknown element": mjcf("<nothing/>"),
        "a model in a model": mjcf("<mujoco/>"),
        "an include of itself": mjcf('<include file="a.xml"/>'),
        "an include of nothing": mjcf('<include file="nothing.xml"/>'),
        "an include of a device": mjcf('<include file="/dev/zero"/>'),
        "a mesh that is a device": mjcf(
            '<asset><mesh name="m" file="/dev/zero"/></asset>', beside='<geom type="mesh" mesh="m"/>'
        ),
        "a texture that is a device": mjcf(
            '<compiler texturedir="/dev"/><asset><texture name="t" type="2d" file="zero"/></asset>'
        ),
        "a mesh of no format": mjcf(
            '<asset><mesh name="m" file="a.xml"/></asset>', beside='<geom type="mesh" mesh="m"/>'
        ),
        "NaN": mjcf(inside='<body pos="nan 0 0"><joint/><geom size=".1"/></body>'),
        "1e308": mjcf(inside='<body pos="1e308 0 0"><joint/><geom size=".1"/></body>'),
        "an unknown plugin": mjcf('<extension><plugin plugin="nothing"/></extension>'),
        "half of a file": mjcf()[:80],
    }.items():
        yield check(f"MJCF: {what}", "a.xml", text)
    for what, data in {"Latin-1": "é".encode("latin-1"), "zeros": b"\0" * 100}.items():
        include = {"a.xml": mjcf('<include file="b.xml"/>'), "b.xml": b"<mujocoinclude a='" + data + b"'/>"}
        yield Case(f"MJCF: an include with {what}", include, ("check", "a.xml"))  # type: ignore[arg-type]


def parquet(columns: Callable[[Any], dict[str, Any]]) -> bytes:
    import pyarrow
    from pyarrow import parquet as writer

    data = BytesIO()
    writer.write_table(pyarrow.table(columns(pyarrow)), data, compression="zstd")
    return data.getvalue()


def tables() -> Iterator[Case]:
    arm = {"a.yaml": YAML.format(**GOOD)}
    for what, text in {
        "commas": ",,,\n" * 10,
        "carriage returns": "\r" * 100,
        "one huge cell": '"' + "a" * 200_000 + '",1\n1,2\n',
        "a quote without end": 'time,"j\n' + "1,2\n" * 1000,
        "zeros": "time,j\n1,\0\n2,3\n",
        "a heading only": "time,j\n",
        "no time": "j\n1\n2\n3\n",
        "no number": "time,j\n0,x\n1,2\n2,3\n",
        "NaN": "time,j\n0,nan\n1,0\n2,0\n",
        "times of 1e308": "time,j\n-1e308,0\n0,0\n1e308,0\n",
        "times 1e300 apart": "time,j\n0,0\n1e300,0\n2e300,0\n",
        "denormal times": "time,j\n0,0\n5e-324,0\n1e-323,0\n",
        "values of 1e308": "time,j\n0,0\n1,1e308\n2,-1e308\n",
        "the same time": "time,j\n0,0\n0,0\n1,0\n",
        "too many cells": "time,j\n0,0,0\n1,1,1\n2,2,2\n",
        "a unit of letters": "time [" + "a" * 40 + "!],j\n0,0\n1,0\n2,0\n",
        "a unit of mass": "time [kg],j\n0,0\n1,0\n2,0\n",
        "a million rows": "time,j\n" + "".join(f"{i},0\n" for i in range(1_000_000)),
        "the same column": "time,j,j\n0,0,0\n1,0,0\n",
        "a thousand columns": ",".join(f"c{i}" for i in range(1000)) + "\n",
        "a million commas": "," * 1_000_000 + "\n1\n",
    }.items():
        yield Case(f"motion: {what}", {**arm, "m.csv": text}, ("simulate", "a.yaml", "--motion", "m.csv"))
        yield Case(f"list: {what}", {**arm, "l.csv": text}, ("stock", "a.yaml", "l.csv"))
    head = "part,kind,rate{0},max_force,free_length,outer_diameter,wire_diameter,mass\n"
    row = "p{0},extension,{1},9,1,.1,.01,1\n"
    for what, text in {
        "a rate of 1e308": head.format("") + row.format(0, "1e308"),
        "a rate of NaN": head.format("") + row.format(0, "nan"),
        "a unit of rates, of letters": head.format(" [" + "a" * 40 + "!]") + row.format(0, 1),
        "parts twice": head.format("") + row.format(0, 1) * 1000,
        "faulty rows": head.format("") + row.format(0, "x") * 50_000,
        "too many springs": head.format("") + "".join(row.format(i, 1) for i in range(100_001)),
    }.items():
        yield Case(f"list: {what}", {**arm, "l.csv": text}, ("stock", "a.yaml", "l.csv"))
    contents: dict[str, Callable[[Any], dict[str, Any]]] = {
        "30 million rows": lambda pa: {"part": pa.nulls(30_000_000, pa.int8())},
        "the same text": lambda pa: {"part": pa.DictionaryArray.from_arrays([0] * 90_000, ["a" * 1_000_000])},
        "a date out of range": lambda pa: {"part": pa.array([2**62], pa.timestamp("us"))},
        "lists": lambda pa: {"part": pa.array([[1]])},
        "no column": lambda pa: {"nothing": pa.array([1])},
    }
    for what, content in contents.items():
        yield Case(f"Parquet: {what}", {**arm, "l.parquet": parquet(content)}, ("stock", "a.yaml", "l.parquet"))
    for what, data in {"no Parquet": b"hello", "only its marks": b"PAR1" * 100, "empty": b""}.items():
        yield Case(f"Parquet: {what}", {**arm, "l.parquet": data}, ("stock", "a.yaml", "l.parquet"))  # type: ignore[arg-type]


KINDS = (quantities, options, no_files, contents, yaml_structure, controls, xml, models, tables)
