"""The paper's numbers are the paper's."""

import pytest

from fuzzynav_mj.fuzzy.risk import RiskGate
from fuzzynav_mj.reporting import published as paper
from fuzzynav_mj.scenarios import PAPER_SCENARIOS


def test_the_averages_are_those_of_the_abstract() -> None:
    """13.11 and 5.31 s with 0.47 and 0.25: the means over the four environments."""
    rows = paper.TABLE_2.values()
    assert sum(row.path for row in rows) / 4 == pytest.approx(13.11, abs=0.005)
    assert sum(row.run_time for row in rows) / 4 == pytest.approx(5.31, abs=0.005)
    assert sum(row.path_std or 0.0 for row in rows) / 4 == pytest.approx(0.47, abs=0.005)
    assert sum(row.run_time_std or 0.0 for row in rows) / 4 == pytest.approx(0.25, abs=0.005)


def test_both_tables_agree_on_the_papers_own_planner() -> None:
    for world in PAPER_SCENARIOS:
        second, third = paper.TABLE_2[world], paper.TABLE_3["fuzzy"][world]
        assert (second.run_time, second.path, second.failures) == (
            third.run_time, third.path, third.failures,
        )  # fmt: skip


AS_PRINTED = """
prm         10.81 14.20 13   5.95 13.61 14  23.94 17.85 27   6.91 10.15 64
rrt         19.43 15.82  9  12.95  5.71 13  27.28 18    21  11.35 10.6  42
dwa         14.25 16.87 65  20    15     9  20.5  18.2  55  13.01 14.20 70
bug         30    16.21  0  14.69 31     0  28.52 20     0  20.11 14.10  0
multilayer   3.14 13.64  0   2.17 13.21  0   7.35 17.67  0   2.04  9.19  0
fuzzy        4.44 13.14  0   4.36 13.20  0   8.95 16.96  0   3.50  9.14  0
"""


def test_table_3_as_printed() -> None:
    """Run time, path length and failures for concave, convex, maze and narrow."""
    assert len(paper.TABLE_3) == 6
    for line in AS_PRINTED.split("\n")[1:-1]:
        planner, *numbers = line.split()
        shown = [
            number
            for world in PAPER_SCENARIOS
            for cell in (paper.TABLE_3[planner][world],)
            for number in (cell.run_time, cell.path, cell.failures)
        ]
        assert shown == [float(number) for number in numbers]


def test_nothing_is_said_of_others() -> None:
    assert paper.published("fuzzy", "trap") is None
    assert paper.published("orca", "maze") is None


def test_the_limit_is_the_gates() -> None:
    assert RiskGate().limit == paper.RISK_LIMIT
