"""Write the example mechanisms that papers' methods and numbers give: arms of lin2010 and lee2014, balanced."""

from __future__ import annotations

from pathlib import Path

from equipoise import save
from equipoise.reproduce import lee2014, lin2010

if __name__ == "__main__":
    folder = Path(__file__).parent
    save(lin2010.balanced().mechanism, folder / "lin2010_balanced.yaml")
    for case in lee2014.CASES:
        save(lee2014.balanced(case), folder / f"lee2014_table5{case.letter}.yaml")
