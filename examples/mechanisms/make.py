"""Write the examples that are designs: the bare mechanisms of the papers, balanced by their methods and numbers."""

from __future__ import annotations

from pathlib import Path

from equipoise import save
from equipoise.reproduce import cho2012, lin2010

DESIGNS = {"lin2010_balanced": lin2010.balanced, "bevel_balanced": cho2012.balanced}

if __name__ == "__main__":
    for name, design in DESIGNS.items():
        save(design().mechanism, Path(__file__).parent / f"{name}.yaml")
