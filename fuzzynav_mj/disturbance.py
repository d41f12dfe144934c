"""How the robot's senses and wheels fall short of perfect ones: the settings, checked."""

from dataclasses import dataclass, fields
from math import degrees, radians

from fuzzynav_mj.errors import FuzzyNavError

LARGEST = {
    "range_noise_m": 0.1,
    "dropouts": 0.5,
    "drift_distance": 0.1,
    "drift_turn_rad": radians(10.0),
}
SMALLEST_FRICTION, LARGEST_FRICTION = 0.1, 1.0


@dataclass(frozen=True, slots=True, order=True)
class Disturbance:
    """What is wrong with the sensors and the floor; nothing by default.

    Attributes:
        range_noise_m: standard deviation of each range reading, m; 0 to 0.1.
        dropouts: share of the rays that report no hit, whatever is there; 0 to 0.5.
        delay_periods: decision periods by which the scan is late; 0 or 1.
        drift_distance: error of the robot's pose estimate per way travelled; 0 to 0.1.
        drift_turn_rad: error of its heading per whole turn, rad; 0 to 10 degrees.
        friction: sliding friction coefficient between wheels and floor; 0.1 to 1, the model's.

    Raises:
        FuzzyNavError: a value is out of its range.
    """

    range_noise_m: float = 0.0
    dropouts: float = 0.0
    delay_periods: int = 0
    drift_distance: float = 0.0
    drift_turn_rad: float = 0.0
    friction: float = LARGEST_FRICTION

    def __post_init__(self) -> None:
        for name, largest in LARGEST.items():
            _check(name, getattr(self, name), 0.0, largest)
        _check("friction", self.friction, SMALLEST_FRICTION, LARGEST_FRICTION)
        if self.delay_periods not in (0, 1):
            raise FuzzyNavError(f"delay_periods: given {self.delay_periods!r}; allowed is 0 or 1")

    @property
    def drifts(self) -> bool:
        """True if the robot's pose estimate is not the truth."""
        return self.drift_distance > 0.0 or self.drift_turn_rad > 0.0

    def __str__(self) -> str:
        """What differs from perfect, in few words; "none" where nothing does."""
        parts = []
        if self.range_noise_m:
            parts.append(f"noise {self.range_noise_m:g} m")
        if self.dropouts:
            parts.append(f"dropouts {100 * self.dropouts:g} %")
        if self.delay_periods:
            parts.append(f"delay {self.delay_periods}")
        if self.drifts:
            turn = round(degrees(self.drift_turn_rad), 6)
            parts.append(f"drift {100 * self.drift_distance:g} %, {turn:g} deg")
        if self.friction != LARGEST_FRICTION:
            parts.append(f"friction {self.friction:g}")
        return ", ".join(parts) or "none"


def _check(name: str, value: float, least: float, most: float) -> None:
    if not least <= value <= most:  # also refuses nan
        raise FuzzyNavError(
            f"{name}: given {value!r}; allowed is a number from {least:g} to {most:.4g}"
        )


PERFECT = Disturbance()
FIELDS = tuple(field.name for field in fields(Disturbance))
