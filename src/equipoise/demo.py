"""The main job on a real robot: what `make demo` runs."""

from __future__ import annotations

from pathlib import Path

from rich.console import RenderableType
from rich.text import Text

from .io import load, save
from .io.files import check_writable
from .model.errors import InputError
from .model.progress import Progress
from .report.figure import save_figure
from .report.text import design_lines
from .synthesis import design

SPAN, RADIUS, SPRINGS = 3, 0.15, 3


def robots() -> Path:
    """The folder of example robots: in a checkout, or inside the installed package."""
    for folder in (Path(__file__).parents[2] / "examples" / "robots", Path(__file__).parent / "robots"):
        if (folder / "ur5.urdf").exists():
            return folder
    raise InputError("the example robots are missing from this installation")


def run(folder: Path, progress: Progress) -> list[RenderableType]:
    """Design springs for a UR5, write the design and its figure to `folder`, and return what to print.

    Raises:
        InputError: the folder cannot be written to.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(f"{folder}: cannot be made: {(error.strerror or str(error)).lower()}") from error
    files = [folder / f"ur5-balanced{suffix}" for suffix in (".yaml", ".svg", ".png")]
    for file in files:
        check_writable(file)
    ur5 = load(robots() / "ur5.urdf")
    found = design(ur5, span=SPAN, radius=RADIUS, shape="box", springs=SPRINGS, front=True, progress=progress)
    save(found.mechanism, files[0])
    progress("drawing", 0.0)
    for file in files[1:]:
        save_figure(found.mechanism, file, balance=found.balance)
    command = f"equipoise design ur5.urdf --span {SPAN} --radius {1e3 * RADIUS:.0f}mm --box --springs {SPRINGS} --front"
    return [
        Text(f"$ {command}", style="dim"),
        *design_lines(found),
        Text(f"wrote {folder}/ur5-balanced.yaml, .svg and .png; judge it again with:", style="dim"),
        Text(f"$ equipoise check {folder}/ur5-balanced.yaml", style="dim"),
    ]
