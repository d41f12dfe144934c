"""The page of a recording that tells a stranger what the other panels show."""

from fuzzynav_mj.recording.scene import MAGNIFICATION
from fuzzynav_mj.recording.tracks import PREDICTION_TIME, spoken
from fuzzynav_mj.types import EpisodeRecord

_LEGEND = f"""
| blue body, yellow front | the robot; the square under it is its footprint |
|---|---|
| grey, orange | obstacles that stand still, and that move |
| green, light blue | goal with its tolerance; way travelled so far |
| thin circles | rings of the range sensor; nothing outside the outer one is seen |
| red dots, arrows | what the sensor hits; where movers may be in {PREDICTION_TIME:g} s |
| cluster of dots | next positions weighed, {MAGNIFICATION:g} times as far off as they are |
| blue, yellow, red dot | next position of risk 0, 50, 100, if evaluated |
| slate, brown dot | not evaluated: admissible, not admissible |
| dot with a black rim | the next position taken |
| purple dot | the subgoal that the robot heads for |
"""


def guide(record: EpisodeRecord, description: str) -> str:
    """Markdown: the episode in a line, then the legend of the scene."""
    episode = (
        f"Planner {record.planner}, seed {record.seed}: **{spoken(record.outcome.value)}** after "
        f"{record.sim_time_s:.1f} s and {record.path_length_m:.2f} m; "
        f"smallest gap {record.min_clearance_m:.3f} m."
    )
    return f"### {record.scenario}\n{description}\n\n{episode}\n{_LEGEND}"
