"""Numbers of an episode: pure functions from what happened to the fields of `EpisodeRecord`."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, fields
from statistics import NormalDist
from typing import Any

import numpy as np
import numpy.typing as npt

from fuzzynav_mj.clearance import clearances, min_clearance
from fuzzynav_mj.types import Decision, EpisodeRecord, FloatArray, Outcome

__all__ = [
    "RiskSummary",
    "clearances",
    "min_clearance",
    "optimality",
    "path_length",
    "percentile_ms",
    "record_to_json",
    "record_to_row",
    "summarise_risk",
    "tracking_rms",
    "wilson_interval",
]


@dataclass(frozen=True, slots=True)
class RiskSummary:
    """Risk over the accepted decisions.

    Attributes:
        maximum: largest risk, 0..100; None where no decision had one.
        mean: mean risk, 0..100; None where no decision had one.
        vetoes: how often the gate changed the next position.
    """

    maximum: float | None
    mean: float | None
    vetoes: int


def path_length(positions: FloatArray) -> float:
    """Length of the polyline through `positions` (n, 2), m: Eqs. (15), (16) of the paper."""
    return float(np.hypot(*np.diff(positions, axis=0).T).sum())


def optimality(shortest: float, travelled: float, outcome: Outcome) -> float | None:
    """Shortest over travelled length; None unless the goal was reached by travelling."""
    if outcome is not Outcome.GOAL_REACHED or travelled <= 0.0:
        return None
    return shortest / travelled


def tracking_rms(commanded: FloatArray, reached: FloatArray) -> float:
    """Root mean square distance between commanded and reached positions, both (n, 2), m.

    nan for n = 0.
    """
    if len(commanded) == 0:
        return math.nan
    return float(np.sqrt(np.mean(np.sum((commanded - reached) ** 2, axis=1))))


def percentile_ms(seconds: npt.ArrayLike, percent: float) -> float:
    """The `percent`-th percentile of times given in s, in ms; nan for no times."""
    values = np.asarray(seconds, dtype=np.float64)
    return float(np.percentile(values, percent)) * 1e3 if values.size else math.nan


def summarise_risk(decisions: Sequence[Decision]) -> RiskSummary:
    """Largest and mean risk of the accepted next positions, and the gate's vetoes."""
    risks = [decision.risk for decision in decisions if not math.isnan(decision.risk)]
    return RiskSummary(
        maximum=max(risks) if risks else None,
        mean=math.fsum(risks) / len(risks) if risks else None,
        vetoes=sum(decision.vetoed for decision in decisions),
    )


def wilson_interval(successes: int, trials: int, confidence: float = 0.95) -> tuple[float, float]:
    """Wilson score interval of a proportion (Wilson 1927): (low, high) within [0, 1].

    No trials tell nothing: (0, 1). Raises ValueError unless 0 <= successes <= trials.
    """
    if not 0 <= successes <= trials:
        raise ValueError(f"successes must be in 0..{trials}, not {successes}")
    if trials == 0:
        return 0.0, 1.0
    z = NormalDist().inv_cdf(0.5 + confidence / 2.0)
    share = successes / trials
    centre = share + z * z / (2 * trials)
    spread = z * math.sqrt(share * (1 - share) / trials + (z / (2 * trials)) ** 2)
    scale = 1 + z * z / trials
    # The ends are exact at 0 and at all successes; rounding would miss them by an ulp.
    low = 0.0 if successes == 0 else (centre - spread) / scale
    high = 1.0 if successes == trials else (centre + spread) / scale
    return low, high


def record_to_json(record: EpisodeRecord) -> dict[str, Any]:
    """The record as plain values under the published field names; null for nan and infinities."""
    values = {field.name: getattr(record, field.name) for field in fields(record)}
    values["contacts"] = [
        {
            "time_s": contact.time_s,
            "with": contact.with_,
            "robot_speed_mps": contact.robot_speed_mps,
            "at_fault": contact.at_fault,
        }
        for contact in record.contacts
    ]
    values["disturbance"] = asdict(record.disturbance)
    return {name: _plain(value) for name, value in values.items()}


def record_to_row(record: EpisodeRecord) -> dict[str, Any]:
    """The record as one flat table row; every record has the same columns, None where empty.

    `contacts` becomes `contacts_count` and the first contact's `contact_*`; `versions` becomes
    one `version_*` column each, and `disturbance` a column for each of its fields.
    """
    row = record_to_json(record)
    contacts, versions = row.pop("contacts"), row.pop("versions")
    row |= row.pop("disturbance")
    first = contacts[0] if contacts else {}
    row["contacts_count"] = len(contacts)
    for name in ("time_s", "with", "robot_speed_mps", "at_fault"):
        row[f"contact_{name}"] = first.get(name)
    return row | {f"version_{name}": version for name, version in versions.items()}


def _plain(value: Any) -> Any:
    """`value` as the types that json knows, with None for what is not finite."""
    if isinstance(value, Mapping):
        return {str(key): _plain(item) for key, item in value.items()}
    if isinstance(value, list):
        return [_plain(item) for item in value]
    if isinstance(value, Outcome):
        return value.value
    if isinstance(value, np.generic):
        value = value.item()
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value
