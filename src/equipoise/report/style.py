"""Colours that colour-blind readers tell apart (Okabe and Ito's, then Tol's), sizes, and text safe to draw."""

from __future__ import annotations

SPRINGS = (
    "#D55E00", "#0072B2", "#CC79A7", "#E69F00", "#56B4E9", "#332288", "#882255", "#999933", "#44AA99", "#AA4499",
)  # fmt: skip
BEFORE, BEFORE_PALE = "#8793A1", "#D3D9E0"
AFTER, AFTER_PALE = "#00805F", "#9AD4C2"
INK, FAINT = "#1D2733", "#5A6673"
BODIES = ("#4C5C6E", "#75869A")
EDGE, GROUND = "#27323F", "#39434F"
FLOOR, GRID, SHADOW = "#F5F7F9", "#DDE2E8", "#E3E7EC"

RC = {
    "font.family": ["sans-serif"],
    "font.sans-serif": ["DejaVu Sans"],
    "font.size": 12,
    "svg.hashsalt": "equipoise",
    "svg.fonttype": "none",  # text stays text: it can be searched and edited
    "pdf.fonttype": 42,
    "text.usetex": False,
}


def spring_colour(i: int) -> str:
    """The colour of spring `i`."""
    return SPRINGS[i % len(SPRINGS)]


def clean(text: str, most: int) -> str:
    """One printable line of at most `most` characters."""
    text = " ".join("".join(letter if letter.isprintable() else " " for letter in text).split())
    return text if len(text) <= most else text[: most - 1].rstrip() + "…"


def power(value: float) -> str:
    """A power of ten such as 1e-9."""
    return f"{value:.0e}".replace("e-0", "e-").replace("e+0", "e")


def number(value: float) -> str:
    """Three significant digits without an exponent where that is short."""
    if value and not 1e-3 <= abs(value) < 1e5:
        return f"{value:.1e}"
    digits = 3 if value == 0 else max(0, 2 - int(f"{abs(value):e}".split("e")[1]))
    text = f"{value:.{digits}f}"
    return text.rstrip("0").rstrip(".") if "." in text and abs(value) < 1e-2 else text
