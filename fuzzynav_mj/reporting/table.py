"""A table as data, and as Markdown and HTML."""

from dataclasses import dataclass
from html import escape


@dataclass(frozen=True, slots=True)
class Table:
    """A table with its caption.

    Attributes:
        title: one line.
        headings: of the columns.
        rows: texts, as many in each as there are headings.
        notes: sentences below the table.
        theirs: indices of the columns that repeat the paper's numbers.
    """

    title: str
    headings: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    notes: tuple[str, ...] = ()
    theirs: frozenset[int] = frozenset()

    def markdown(self) -> str:
        """The table under a heading; the paper's columns in italics."""
        lines = [f"### {self.title}", "", _markdown_row(self._marked(self.headings))]
        lines.append("|" + " --- |" * len(self.headings))
        lines += [_markdown_row(self._marked(row)) for row in self.rows]
        return "\n".join([*lines, "", *(f"{note}\n" for note in self.notes)])

    def html(self) -> str:
        """The table under a heading; the paper's columns have the class `theirs`."""
        head = "".join(self._html_cell("th", i, text) for i, text in enumerate(self.headings))
        body = "\n".join(
            "<tr>" + "".join(self._html_cell("td", i, text) for i, text in enumerate(row)) + "</tr>"
            for row in self.rows
        )
        notes = "\n".join(f'<p class="note">{escape(note)}</p>' for note in self.notes)
        return (
            f"<h3>{escape(self.title)}</h3>\n"
            f'<div class="scroll"><table>\n<thead><tr>{head}</tr></thead>\n'
            f"<tbody>\n{body}\n</tbody>\n</table></div>\n{notes}\n"
        )

    def _marked(self, cells: tuple[str, ...]) -> list[str]:
        return [f"*{c}*" if i in self.theirs and c != "-" else c for i, c in enumerate(cells)]

    def _html_cell(self, tag: str, column: int, text: str) -> str:
        mark = ' class="theirs"' if column in self.theirs else ""
        return f"<{tag}{mark}>{escape(text)}</{tag}>"


def _markdown_row(cells: list[str]) -> str:
    return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"
