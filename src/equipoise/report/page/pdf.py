"""A report as a PDF, through typst: the same content, tagged for screen readers, the same bytes for the same input."""

from __future__ import annotations

import json
from importlib.resources import files
from typing import Any

from .content import Block, Cell, Code, Items, Number, Paragraph, Picture, Report, Table
from .pictures import plain


def pdf(report: Report) -> bytes:
    """The file's content; needs typst, and matplotlib for its fonts."""
    import matplotlib
    import typst

    content = {
        "title": report.title,
        "verdict": report.verdict,
        "good": report.good,
        "sections": [{"title": s.title, "blocks": [_block(one) for one in s.blocks]} for s in report.sections],
    }
    return typst.compile(
        files("equipoise.report.page").joinpath("page.typ").read_bytes(),
        format="pdf",
        sys_inputs={"report": json.dumps(content)},
        font_paths=[f"{matplotlib.get_data_path()}/fonts/ttf"],  # type: ignore[arg-type]  # its stub forgets text
        ignore_system_fonts=True,  # the same on every machine
        timestamp=0,
    )


def _block(one: Block) -> dict[str, Any]:
    match one:
        case Paragraph(text, strong):
            return {"kind": "paragraph", "text": text, "strong": strong}
        case Items(texts):
            return {"kind": "items", "texts": list(texts)}
        case Code(text, what):
            return {"kind": "code", "text": text.rstrip(), "what": what}
        case Picture(svg, caption, said, narrow):
            return {"kind": "picture", "svg": plain(svg), "caption": caption, "said": said, "narrow": narrow}
        case Table(caption, head, rows):
            cells = [[_text(cell) for cell in row] for row in rows]
            return {
                "kind": "table", "caption": caption, "head": list(head), "rows": cells, "numeric": list(one.numeric)
            }  # fmt: skip


def _text(cell: Cell) -> str:
    return cell.text if isinstance(cell, Number) else cell
