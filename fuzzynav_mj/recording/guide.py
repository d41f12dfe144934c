"""The page of a recording that tells a stranger what the other panels show."""

from fuzzynav_mj.recording.scene import MAGNIFICATION
from fuzzynav_mj.recording.tracks import PREDICTION_TIME, spoken
from fuzzynav_mj.types import EpisodeRecord

_LEGEND = f"""
| blue body, yellow front | the robot; the square under it is its footprint |
|---|---|
| grey, orange | obstacles that stand still, and that move |
| green | goal with its tolerance |
| light blue | way travelled so far |
| thin circles | rings of the range sensor; nothing outside the outer one is seen |
| red dots | what the range sensor hits now |
| red arrows | where the robot expects movers within {PREDICTION_TIME:g} s |
| dots about the robot | next positions weighed, drawn {MAGNIFICATION:g} times as far off; |
| | blue, yellow, red by rising risk, grey if not evaluated |
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
