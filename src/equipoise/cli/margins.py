"""The margins that every command asks of springs, unless others are typed."""

from __future__ import annotations

from typing import Annotated

import typer

Safety = Annotated[float, typer.Option(min=0.01, help="static margin asked for: permissible over largest stress")]
Fatigue = Annotated[float, typer.Option(min=0, help="Goodman margin asked for at --cycles; 0: none")]
Cycles = Annotated[float, typer.Option(min=1, help="from the least to the largest force and back, to live through")]
