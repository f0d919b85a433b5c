"""A report as one HTML file that loads nothing: for screens in light and dark, paper, and screen readers."""

from __future__ import annotations

import html
import json
from importlib.resources import files

from ...model.errors import visible
from .content import Block, Cell, Code, Items, Number, Paragraph, Picture, Report, Table


def page(report: Report) -> str:
    """The file's text; needs jinja2."""
    from jinja2 import Environment, StrictUndefined

    # in a script element only "<" can end it
    data = {name: json.dumps(value, allow_nan=False).replace("<", "\\u003c") for name, value in report.data.items()}
    template = files("equipoise.report.page").joinpath("page.html").read_text("utf-8")
    environment = Environment(autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True)
    return environment.from_string(template).render(report=report, data=data, block=block)


def block(one: Block) -> str:
    """One piece of a section."""
    match one:
        case Paragraph(text, strong):
            return f"<p{' class=answer' if strong else ''}>{escape(text)}</p>"
        case Items(texts):
            return "<ul>" + "".join(f"<li>{escape(text)}</li>" for text in texts) + "</ul>"
        case Code(text, what):
            return (
                f'<figure><figcaption>{escape(what)}</figcaption><pre tabindex="0" role="region" '
                f'aria-label="{escape(what)}"><code>{escape(text.rstrip())}</code></pre></figure>'
            )
        case Picture(svg, caption, _, narrow):
            return (
                f"<figure{' class=narrow' if narrow else ''}>{svg}<figcaption>{escape(caption)}</figcaption></figure>"
            )
        case Table():
            return _table(one)


def _table(table: Table) -> str:
    numeric = table.numeric
    head = "".join(
        f'<th scope="col"{" class=number" if right else ""}>{escape(title)}</th>' if title else "<td></td>"
        for title, right in zip(table.head, numeric, strict=True)
    )
    rows = []
    for first, *rest in table.rows:
        cells = "".join(_cell(cell, right) for cell, right in zip(rest, numeric[1:], strict=True))
        rows.append(f'<tr><th scope="row">{_text(first)}</th>{cells}</tr>')
    caption, dense = escape(table.caption), " class=dense" if len(table.head) > 8 else ""
    return (
        f'<div class="wide" tabindex="0" role="region" aria-label="{caption}"><table{dense}>'
        f"<caption>{caption}</caption><thead><tr>{head}</tr></thead><tbody>{''.join(rows)}</tbody></table></div>"
    )


def _cell(cell: Cell, right: bool) -> str:
    return f"<td{' class=number' if right else ''}>{_text(cell)}</td>"


def _text(cell: Cell) -> str:
    if isinstance(cell, Number):
        return f'<data value="{float(cell.value)!r}">{escape(cell.text)}</data>'
    return escape(cell)


def escape(text: str) -> str:
    """Text of a page, with what a terminal or a reader of the file would obey written out."""
    return html.escape(visible(text, "\t\n"))
