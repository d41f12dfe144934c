"""Risk against step with the gate, and how the highest risk came about (figure 9)."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from fuzzynav_mj.fuzzy.completion import Origin
from fuzzynav_mj.fuzzy.membership import RISK_MAX, DistanceTerm, RiskTerm
from fuzzynav_mj.fuzzy.risk import Explanation, FiredRule, RiskGate
from fuzzynav_mj.fuzzy.rules import INPUTS
from fuzzynav_mj.recording.colours import BLUE, VERMILLION
from fuzzynav_mj.reporting.style import Picture, hex_colour, look, new_figure
from fuzzynav_mj.reporting.traces import RiskPeak, Trace

RULES_SHOWN = 4
PAPER = {"facecolor": "white", "edgecolor": "none", "pad": 0.5}
INPUT_NAMES = {
    "LS": "left static", "FS": "front static", "RS": "right static",
    "LD": "left dynamic", "FD": "front dynamic", "RD": "right dynamic",
}  # fmt: skip
TERM_NAMES = {
    DistanceTerm.VF: "very far", DistanceTerm.F: "far", DistanceTerm.M: "medium",
    DistanceTerm.C: "close",
}  # fmt: skip
RISK_NAMES = {
    RiskTerm.VL: "very low", RiskTerm.L: "low", RiskTerm.N: "normal", RiskTerm.H: "high",
    RiskTerm.VH: "very high",
}  # fmt: skip
ORIGINS = {
    Origin.PUBLISHED: "published", Origin.MIRROR: "mirror image of published",
    Origin.ANCHOR: "fixed by hand",
}  # fmt: skip


def risk_picture(trace: Trace, gate: RiskGate) -> Picture | None:
    """The risk of every step of an episode; None where no step was judged."""
    if trace.peak is None:
        return None
    name = trace.job.scenario.name
    explanation = gate.explain(trace.peak.inputs)
    what = "refused" if trace.peak.refused else "taken, for want of a better one"
    if trace.peak.risk <= gate.limit:
        what = "taken"
    return Picture(
        "risk",
        f"Risk of planner {trace.job.planner} in {name}, seed {trace.job.seed} (as figure 9)",
        f"Above: risk of the accepted next position at every step, the gate's limit of "
        f"{gate.limit:g}, and the next positions that it refused. Below: how the highest risk, "
        f"{trace.peak.risk:.1f} at step {trace.peak.step}, came about; that next position was "
        f"{what}. Left: the six distances and their grades; middle: the risk's terms as strong as "
        "the rules make them, with their centroid; right: the strongest rules.",
        _figure(trace, trace.peak, explanation, gate),
    )


def _figure(trace: Trace, peak: RiskPeak, explanation: Explanation, gate: RiskGate) -> Figure:
    with look():
        figure = new_figure(9.6, 6.4)
        grid = figure.add_gridspec(2, 3, height_ratios=(1.0, 1.0), width_ratios=(1.15, 1.2, 1.15))
        _steps(figure.add_subplot(grid[0, :]), trace, peak, gate)
        _grades(figure.add_subplot(grid[1, 0]), explanation)
        _output(figure.add_subplot(grid[1, 1]), explanation, gate)
        _rules(figure.add_subplot(grid[1, 2]), explanation)
    return figure


def _steps(axes: Axes, trace: Trace, peak: RiskPeak, gate: RiskGate) -> None:
    steps = np.arange(len(trace.risks))
    axes.plot(steps, trace.risks, color=hex_colour(BLUE), linewidth=1.0, label="accepted")
    refused = np.flatnonzero(~np.isnan(trace.proposed))
    mark = {"linestyle": "", "marker": "v", "color": hex_colour(VERMILLION)}
    if len(refused):
        axes.plot(
            refused, trace.proposed[refused], **mark, markeredgecolor="black", label="refused"
        )
    axes.axhline(gate.limit, color="black", linestyle="--", linewidth=1.0)
    axes.text(
        len(steps) * 1.005, gate.limit, f"gate {gate.limit:g}", va="center", ha="left", fontsize=8
    )
    left = peak.step < len(steps) / 2
    axes.annotate(
        f"step {peak.step}: {peak.risk:.1f}",
        (peak.step, peak.risk),
        xytext=(12 if left else -12, 10),
        textcoords="offset points",
        ha="left" if left else "right",
        va="bottom",
        arrowprops={"arrowstyle": "-", "linewidth": 0.8},
    )
    axes.set_xlim(0, max(1, len(steps) - 1))
    axes.set_ylim(0.0, 118.0)
    axes.set_yticks(range(0, 101, 20))
    axes.set_xlabel("step (one decision, 0.1 s)")
    axes.set_ylabel("risk, 0 to 100")
    axes.legend(loc="upper right", ncols=2, frameon=False)


def _grades(axes: Axes, explanation: Explanation) -> None:
    """The grade of each term of each input, darker for more."""
    terms = list(reversed(DistanceTerm))  # close first
    grades = np.array([[explanation.memberships[name][t] for t in terms] for name in INPUTS])
    axes.imshow(grades, cmap="Greys", vmin=0.0, vmax=1.3, aspect="auto")
    for row, column in np.ndindex(grades.shape):
        grade = grades[row, column]
        axes.text(
            column, row, f"{grade:.2f}" if grade else "0", ha="center", va="center",
            color="white" if grade > 0.6 else "black",
        )  # fmt: skip
    labels = []
    for name in INPUTS:
        distance = getattr(explanation.inputs, name)
        shown = f"{distance:.2f} m" if distance < 1.0 else "none in sight"
        labels.append(f"{INPUT_NAMES[name]}\n{shown}")
    axes.set_yticks(range(len(INPUTS)), labels, fontsize=7.5)
    axes.set_xticks(range(len(terms)), [TERM_NAMES[term] for term in terms], fontsize=8)
    axes.tick_params(length=0)
    axes.set_title("inputs: grades of the terms")


def _output(axes: Axes, explanation: Explanation, gate: RiskGate) -> None:
    """The clipped terms of the risk, their union, and its centroid."""
    risk = np.linspace(0.0, RISK_MAX, 1001)
    grades = gate.memberships.risk_grades(risk)
    strengths = np.array([explanation.strengths[term] for term in RiskTerm])
    for term in RiskTerm:
        axes.plot(risk, grades[:, term], color="0.6", linewidth=0.8)
        middle = float(np.median(risk[grades[:, term] >= 1.0]))
        name = RISK_NAMES[term].replace(" ", "\n")
        axes.text(middle, 1.04, name, ha="center", fontsize=7.5, bbox=PAPER, zorder=6)
    union = np.minimum(grades, strengths).max(axis=1)
    axes.fill_between(
        risk, union, facecolor=hex_colour(BLUE), alpha=0.45, hatch="///", edgecolor="black"
    )
    axes.axvline(gate.limit, color="black", linestyle="--", linewidth=1.0)
    axes.axvline(explanation.risk, color=hex_colour(VERMILLION), linewidth=2.0)
    axes.plot(explanation.risk, 0.0, marker="^", color=hex_colour(VERMILLION),
              markeredgecolor="black", markersize=9, clip_on=False, zorder=5)  # fmt: skip
    axes.set_xlim(0.0, RISK_MAX)
    axes.set_ylim(0.0, 1.25)
    axes.set_yticks([0.0, 0.5, 1.0])
    axes.set_xlabel(f"risk: centroid {explanation.risk:.1f} (triangle), gate {gate.limit:g}")
    axes.set_ylabel("grade")
    axes.set_title("output: terms as strong as their rules")


def _rules(axes: Axes, explanation: Explanation) -> None:
    axes.axis("off")
    fired = len(explanation.rules)
    axes.set_title("the rule that fired" if fired == 1 else f"the strongest of {fired} rules")
    texts = [_rule_text(rule) for rule in explanation.rules[:RULES_SHOWN]]
    axes.text(0.0, 0.98, "\n\n".join(texts), va="top", fontsize=8, transform=axes.transAxes)


def _rule_text(rule: FiredRule) -> str:
    """A rule in words; what is very far is not mentioned."""
    parts = [
        f"{INPUT_NAMES[name]} {TERM_NAMES[term]}"
        for name, term in zip(INPUTS, rule.antecedent, strict=True)
        if term is not DistanceTerm.VF
    ]
    lines = ["if " + "\n  and ".join(parts) if parts else "if nothing is near"]
    source = ORIGINS.get(rule.origin, "completed")
    numbers = f" {', '.join(map(str, rule.numbers))}" if rule.numbers else ""
    lines.append(f"then {RISK_NAMES[rule.consequent]}, strength {rule.strength:.2f}")
    lines.append(f"  ({source}{numbers})")
    return "\n".join(lines)
