"""How the report's pictures look, and how they become files.

Colours are Okabe and Ito's, which colour-blind readers can tell apart; whatever a colour says is
also said by a hatch, a marker, a dash pattern or a label, so that grey prints stay readable.
"""

from collections.abc import Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path

from matplotlib import style
from matplotlib.figure import Figure

from fuzzynav_mj.planners.base import Requirements
from fuzzynav_mj.recording.colours import (
    BLACK,
    BLUE,
    GREEN,
    GREY,
    ORANGE,
    PURPLE,
    SKY_BLUE,
    VERMILLION,
    Colour,
)
from fuzzynav_mj.reporting.contents import given_text
from fuzzynav_mj.results import replace_file

DPI = 130
SETTINGS = {
    "font.family": "DejaVu Sans",  # comes with matplotlib
    "font.size": 9.0,
    "axes.titlesize": 10.0,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "hatch.linewidth": 0.6,
    "text.parse_math": False,  # names may hold any character
    "svg.hashsalt": "fuzzynav_mj",  # else the ids in the file are drawn at random
}


@dataclass(frozen=True, slots=True)
class LineStyle:
    """How the way of one planner is drawn."""

    colour: str
    dashes: str | tuple[float, tuple[float, ...]]
    marker: str


@dataclass(frozen=True, slots=True)
class FillStyle:
    """How the bars of planners that are given the same are drawn."""

    colour: str
    hatch: str


@dataclass(frozen=True, slots=True, eq=False)
class Picture:
    """A picture of the report.

    Attributes:
        name: of its files, without suffix.
        title: one line.
        text: what it shows, for readers and for those who cannot see it.
        figure: the picture itself.
    """

    name: str
    title: str
    text: str
    figure: Figure

    def write(self, folder: Path) -> bytes:
        """Write the picture as PNG and as SVG; the same figure gives the same bytes.

        Returns:
            The content of the PNG file.

        Raises:
            FuzzyNavError: a file cannot be written.
        """
        _settle(self.figure)
        png = _rendered(self.figure, "png")
        replace_file(folder / f"{self.name}.png", png)
        replace_file(folder / f"{self.name}.svg", _rendered(self.figure, "svg"))
        return png


def hex_colour(colour: Colour) -> str:
    """A colour as matplotlib takes it."""
    return "#{:02x}{:02x}{:02x}".format(*colour)


_COLOURS = [hex_colour(c) for c in (BLUE, VERMILLION, GREEN, ORANGE, PURPLE, SKY_BLUE, BLACK, GREY)]
_DASHES: list[str | tuple[float, tuple[float, ...]]] = [
    "-", (0, (6, 2)), (0, (1.5, 1.5)), (0, (6, 2, 1.5, 2)), (0, (3, 1.5)), (0, (9, 3)),
    (0, (6, 1.5, 1.5, 1.5, 1.5, 1.5)),
]  # fmt: skip
_MARKERS = ["o", "s", "^", "D", "v", "P", "<", ">", "h", "X", "*"]


def line_styles(names: Sequence[str]) -> dict[str, LineStyle]:
    """A style for each name; the numbers of colours, dashes and markers have no common factor."""
    return {
        name: LineStyle(
            _COLOURS[i % len(_COLOURS)], _DASHES[i % len(_DASHES)], _MARKERS[i % len(_MARKERS)]
        )
        for i, name in enumerate(names)
    }


def fill_style(needs: Requirements | None) -> FillStyle:
    """The style of bars by what a planner is given."""
    styles = {
        "nothing more": FillStyle(hex_colour(GREY), ""),
        "scan": FillStyle(hex_colour(SKY_BLUE), "..."),
        "obstacles": FillStyle(hex_colour(BLUE), "///"),
        "static map": FillStyle(hex_colour(VERMILLION), "\\\\\\"),
        "scan + static map": FillStyle(hex_colour(ORANGE), "xxx"),
        "obstacles + static map": FillStyle(hex_colour(PURPLE), "|||"),
    }
    return styles.get(given_text(needs), FillStyle("#ffffff", "oo"))


def new_figure(width: float, height: float) -> Figure:
    """An empty figure of `width` by `height` inches that keeps labels from overlapping."""
    figure = Figure(figsize=(width, height), dpi=DPI, layout="constrained")
    # Text is a little wider in one kind of file than in the other; the pads leave it room.
    figure.get_layout_engine().set(w_pad=0.10, h_pad=0.06)
    return figure


def look() -> AbstractContextManager[None]:
    """The settings under which figures are drawn and written, whatever the user's own are."""
    context: AbstractContextManager[None] = style.context(["default", SETTINGS])
    return context


def _settle(figure: Figure) -> None:
    """Lay the figure out once, to rounded places: the last bits of a layout vary between runs."""
    with look():
        figure.draw_without_rendering()
        figure.set_layout_engine("none")
        for axes in figure.axes:
            places = axes.get_position(original=True).bounds
            axes.set_position([round(place, 5) for place in places])


def _rendered(figure: Figure, kind: str) -> bytes:
    buffer = BytesIO()
    metadata = {"Date": None} if kind == "svg" else {"Software": None}
    with look():
        figure.savefig(buffer, format=kind, dpi=DPI, metadata=metadata)
    return buffer.getvalue()
