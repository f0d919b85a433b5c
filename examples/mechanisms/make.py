"""Write the examples that are designs: the bare mechanisms of the papers, balanced by their methods and numbers."""

from __future__ import annotations

from pathlib import Path

from equipoise import save
from equipoise.reproduce import cho2012, lee2014, lin2010

DESIGNS = {"lin2010_balanced": lin2010.balanced, "bevel_balanced": cho2012.balanced}

if __name__ == "__main__":
    folder = Path(__file__).parent
    for name, design in DESIGNS.items():
        save(design().mechanism, folder / f"{name}.yaml")
    for case in lee2014.CASES:
        save(lee2014.balanced(case), folder / f"lee2014_table5{case.letter}.yaml")
