"""Membership functions (figures 5 and 6a) and decision surfaces (figures 6b to 6j)."""

from collections.abc import Iterator

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from fuzzynav_mj.fuzzy.membership import DISTANCE_MAX, RISK_MAX, DistanceTerm, RiskTerm, Trapezoid
from fuzzynav_mj.fuzzy.risk import RiskGate
from fuzzynav_mj.fuzzy.rules import INPUTS
from fuzzynav_mj.recording.colours import BLACK, BLUE, GREEN, ORANGE, VERMILLION
from fuzzynav_mj.reporting.risk_figure import INPUT_NAMES, RISK_NAMES, TERM_NAMES
from fuzzynav_mj.reporting.style import Picture, hex_colour, look, new_figure
from fuzzynav_mj.types import FloatArray

PAIRS = (
    ("LS", "FS"), ("FS", "RS"), ("LS", "RS"),
    ("LD", "FD"), ("FD", "RD"), ("LD", "RD"),
    ("LS", "LD"), ("FS", "FD"), ("RS", "RD"),
)  # fmt: skip
"""Nine surfaces, as the paper shows; it does not say over which pairs."""

STEPS = 81
CLEAR = 1.0  # the other four inputs: nothing in range
LEVELS = (0.0, *np.arange(5.0, RISK_MAX, 10.0), RISK_MAX)
"""Between whole tens: the centroid of Normal is exactly 50, and a contour there would be noise."""

LABELLED = {15.0: "white", 35.0: "white", 55.0: "black", 85.0: "black"}  # on dark, on light
LINES = [(BLUE, "-"), (VERMILLION, "--"), (GREEN, "-."), (ORANGE, ":"), (BLACK, (0, (1, 1, 5, 1)))]


def fuzzy_pictures(gate: RiskGate) -> Iterator[Picture]:
    """The fuzzy system in two pictures."""
    yield Picture(
        "memberships",
        "Membership functions (as figures 5 and 6a)",
        "Left: the terms of each of the six distances. Right: the terms of the risk, with the "
        f"gate's limit of {gate.limit:g}.",
        _memberships(gate),
    )
    yield Picture(
        "surfaces",
        "Decision surfaces (as figures 6b to 6j)",
        "Risk over two of the six distances, the other four clear. Thick dashed line: the gate's "
        f"limit of {gate.limit:g}. Which pairs the paper shows is not said; these are the pairs of "
        "the same kind and of the same side.",
        _surfaces(gate),
    )


def surface(gate: RiskGate, first: str, second: str) -> tuple[FloatArray, FloatArray]:
    """Risk over two inputs, the other four clear.

    Returns:
        (n,) distances, m, and (n, n) risks; rows follow the second input, columns the first.
    """
    distances = np.linspace(0.0, DISTANCE_MAX, STEPS)
    rows = np.full((STEPS * STEPS, len(INPUTS)), CLEAR)
    rows[:, INPUTS.index(first)] = np.tile(distances, STEPS)
    rows[:, INPUTS.index(second)] = np.repeat(distances, STEPS)
    return distances, gate.risks(rows).reshape(STEPS, STEPS)


def _memberships(gate: RiskGate) -> Figure:
    with look():
        figure = new_figure(9.6, 2.9)
        left, right = figure.subplots(1, 2)
        distance = gate.memberships.distance_terms
        order = [DistanceTerm.C, DistanceTerm.M, DistanceTerm.F, DistanceTerm.VF]
        _terms(left, [(TERM_NAMES[t], distance[t]) for t in order], DISTANCE_MAX)
        left.set_xlabel("distance to the nearest obstacle in a sector, m")
        risk = gate.memberships.risk_terms
        _terms(right, [(RISK_NAMES[t], risk[t]) for t in RiskTerm], RISK_MAX)
        right.set_xlabel("risk, 0 to 100")
        right.axvline(gate.limit, color="0.4", linewidth=1.0, linestyle="--")
        right.text(gate.limit - 1, 0.45, f"gate {gate.limit:g}", ha="right", fontsize=8)
    return figure


def _terms(axes: Axes, terms: list[tuple[str, Trapezoid]], most: float) -> None:
    for (name, shape), (colour, dashes) in zip(terms, LINES, strict=False):
        knots = [shape.a, shape.b, shape.c, shape.d]
        grades = [shape.grade(x) for x in knots]
        axes.plot(knots, grades, color=hex_colour(colour), linestyle=dashes, linewidth=2.0)
        sides = {(True, False): "left", (False, True): "right"}
        side = sides.get((shape.b <= 0.0, shape.c >= most), "center")
        where = {"left": 0.01 * most, "right": most}.get(side, (shape.b + shape.c) / 2)
        axes.text(where, 1.03, name, ha=side, color=hex_colour(colour))
    axes.set_xlim(0.0, most)
    axes.set_ylim(0.0, 1.15)
    axes.set_yticks([0.0, 0.5, 1.0])
    axes.set_ylabel("grade")


def _surfaces(gate: RiskGate) -> Figure:
    with look():
        figure = new_figure(9.2, 8.6)
        grid = figure.subplots(3, 3)
        for axes, (first, second) in zip(grid.flat, PAIRS, strict=True):
            distances, risks = surface(gate, first, second)
            filled = axes.contourf(distances, distances, risks, levels=LEVELS, cmap="cividis")
            thin = axes.contour(
                distances,
                distances,
                risks,
                levels=list(LABELLED),
                linewidths=0.5,
                colors=list(LABELLED.values()),
            )
            axes.clabel(thin, fmt="%g", fontsize=6.5)
            if risks.min() < gate.limit < risks.max():
                axes.contour(
                    distances, distances, risks, levels=[gate.limit], linewidths=2.2,
                    colors=hex_colour(VERMILLION), linestyles="--",
                )  # fmt: skip
            axes.set_xlabel(f"{first}: {INPUT_NAMES[first]}, m")
            axes.set_ylabel(f"{second}: {INPUT_NAMES[second]}, m")
            axes.set_aspect("equal")
        bar = figure.colorbar(filled, ax=grid, shrink=0.6, ticks=np.linspace(0.0, RISK_MAX, 6))
        bar.set_label("risk, 0 to 100")
        bar.ax.axhline(gate.limit, color=hex_colour(VERMILLION), linestyle="--", linewidth=2.2)
    return figure
