"""Long campaigns over seeds or examples: whole under `make deep`, a twentieth everywhere else.

@campaign(20_000)
def test_everything_agrees(seeds):            # a block of the numbers 0, 1, 2, ...
    for seed in seeds: ...

@fuzzed(10_000)
@given(...)
def test_nothing_escapes(...): ...

@pytest.mark.deep
@pytest.mark.parametrize("paper", some(PAPERS, here=PAPERS[:1]))
def test_paper(paper): ...
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable
from typing import TypeVar

import pytest
from hypothesis import settings

SHARE = 1 if os.environ.get("EQUIPOISE_DEEP") else 20
"""One in so many is run."""

BLOCK = 500  # seeds that one test goes through: `make deep` spreads the tests over processes

Test = TypeVar("Test", bound=Callable[..., None])
Case = TypeVar("Case")


def share(count: int) -> int:
    """How many of `count` are run here."""
    return -(-count // SHARE)


def some(cases: Iterable[Case], here: Iterable[Case]) -> list[Case]:
    """All cases under `make deep`, those of `here` elsewhere."""
    return list(cases if SHARE == 1 else here)


def campaign(count: int, block: int = BLOCK) -> Callable[[Test], Test]:
    """Give a test the numbers from 0 to `count` - 1 as `seeds`, in blocks; it goes through a block in a loop."""
    most = share(count)
    blocks = [range(first, min(first + block, most)) for first in range(0, most, block)]
    names = [f"{seeds.start}-{seeds.stop - 1}" for seeds in blocks]

    def mark(test: Test) -> Test:
        return pytest.mark.deep(pytest.mark.parametrize("seeds", blocks, ids=names)(test))

    return mark


def fuzzed(count: int) -> Callable[[Test], Test]:
    """Let hypothesis try `count` examples."""

    def mark(test: Test) -> Test:
        return pytest.mark.deep(settings(max_examples=share(count))(test))

    return mark
