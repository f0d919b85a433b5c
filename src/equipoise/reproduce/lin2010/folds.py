"""Where the real RSSR modules of lin2010 fold (Sec. 4)."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ...kinematics import Tree
from ...synthesis.arms.moments import segments
from ...synthesis.pseudobase.parallelograms import widths
from ..record import Row, proved
from .arm import TIMES, arm, balanced, motion
from .tables import PAPER, TABLE_2, point

FOLDED = {2: "3.50", 6: "6.22"}  # [s]


def folds() -> Iterator[Row]:
    """Where real RSSR modules fold (Sec. 4)."""
    bare = arm()
    links = {link.name: link for link in segments(bare)}
    modules = [(links[f"link {i}"], np.array(point(row.c)) - links[f"link {i}"].origin) for i, row in TABLE_2.items()]
    width = widths(Tree.of(bare), modules, motion())
    count = 0
    for j, i in enumerate(TABLE_2):
        crossed = np.flatnonzero(np.diff(np.sign(width[:, j])) != 0)
        if not len(crossed):
            continue
        count += 1
        k = int(crossed[0])
        share = width[k, j] / (width[k, j] - width[k + 1, j])
        at = float(TIMES[k] + share * (TIMES[k + 1] - TIMES[k]))
        item = f"time at which the module of link {i} folds in the paper's own motion, with real joints"
        yield Row(
            PAPER,
            item,
            None,
            at,
            "s",
            golden=FOLDED.get(i, f">= {TIMES[-1]:g}"),  # the others do not fold on the way
            note="C, the joint's axis and the vertical are in one plane",
        )
    yield Row(PAPER, "modules that fold in the paper's own motion", None, count, golden=float(len(FOLDED)))
    real = balanced(real=True)
    yield Row(
        PAPER,
        "modules that fold within +-0.3 rad of a pose between",
        None,
        len(real.free_parameters["folds"]),
        golden=0.0,
    )
    yield proved(PAPER, "real RSSR joints, on the branch of the assembly pose", real.balance, "0")
