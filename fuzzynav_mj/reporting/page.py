"""The report as one page: Markdown beside its pictures, HTML with the pictures inside."""

from base64 import b64encode
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from html import escape

from fuzzynav_mj.reporting.style import Picture
from fuzzynav_mj.reporting.table import Table

STYLE = """\
body { font: 16px/1.5 sans-serif; color: #111; background: #fff; max-width: 75rem;
  margin: 2rem auto; padding: 0 1rem; }
table { border-collapse: collapse; font-size: 0.85rem; white-space: nowrap; }
th, td { border: 1px solid #bbb; padding: 0.25rem 0.5rem; text-align: left; }
th { background: #eee; }
.theirs { font-style: italic; background: #f7f1e3; }
.scroll { overflow-x: auto; }
.note, figcaption { font-size: 0.9rem; color: #444; max-width: 60rem; }
figure { margin: 1rem 0 2.5rem; }
img { max-width: 100%; height: auto; }
"""


@dataclass(frozen=True, slots=True, eq=False)
class Section:
    """A part of the page.

    Attributes:
        title: one line.
        lines: paragraphs.
        parts: what follows them, each with the content of its PNG file where it is a picture.
    """

    title: str
    lines: Sequence[str] = ()
    parts: Sequence[Table | tuple[Picture, bytes]] = ()


def markdown_page(title: str, sections: Iterable[Section]) -> str:
    """The page as Markdown, which names the pictures' files."""
    lines = [f"# {title}", ""]
    for section in sections:
        lines += [f"## {section.title}", ""]
        lines += [f"{line}\n" for line in section.lines]
        for part in section.parts:
            if isinstance(part, Table):
                lines += [part.markdown()]
            else:
                picture, _ = part
                lines += [f"### {picture.title}", "", f"![{picture.title}]({picture.name}.png)", ""]
                lines += [picture.text, ""]
    return "\n".join(lines)


def html_page(title: str, sections: Iterable[Section]) -> str:
    """The page as HTML that needs no other file."""
    body = [f"<h1>{escape(title)}</h1>"]
    for section in sections:
        body.append(f"<h2>{escape(section.title)}</h2>")
        body += [f"<p>{escape(line)}</p>" for line in section.lines]
        for part in section.parts:
            body.append(part.html() if isinstance(part, Table) else _figure(*part))
    return (
        '<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f"<title>{escape(title)}</title>\n<style>\n{STYLE}</style>\n</head>\n<body>\n"
        + "\n".join(body)
        + "\n</body>\n</html>\n"
    )


def _figure(picture: Picture, png: bytes) -> str:
    source = f"data:image/png;base64,{b64encode(png).decode()}"
    return (
        f"<h3>{escape(picture.title)}</h3>\n<figure>\n"
        f'<img src="{source}" alt="{escape(picture.text)}">\n'
        f"<figcaption>{escape(picture.text)}</figcaption>\n</figure>"
    )
