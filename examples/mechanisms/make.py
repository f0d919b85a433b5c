"""Write lin2010_balanced.yaml: the arm of lin2010_arm.yaml balanced by the paper's method with the paper's numbers."""

from __future__ import annotations

from pathlib import Path

from equipoise import save
from equipoise.reproduce.lin2010 import balanced

if __name__ == "__main__":
    save(balanced().mechanism, Path(__file__).parent / "lin2010_balanced.yaml")
