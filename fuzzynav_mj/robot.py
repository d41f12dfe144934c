"""Lengths, speeds, rings and periods of the robot: their only home."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class RobotSpec:
    """Parameters of the square differential-drive robot (SI units, radians).

    The wheel radius, the track and the axle's offset repeat what `models/robots/diff_drive.xml`
    holds; a test compares the two.
    """

    side: float = 0.20
    rings: tuple[float, ...] = (0.2, 0.4, 0.6, 0.8)  # Eq. (9); the last one is the sensor's range
    ray_count: int = 180
    max_speed: float = 0.5  # forwards and backwards
    max_acceleration: float = 2.0
    max_yaw_rate: float = 3.0
    # With 2 m/s2 forwards this keeps the wheels below the servos' limit of 2.95 m/s2.
    max_yaw_acceleration: float = 10.0
    decision_period: float = 0.1
    physics_period: float = 0.005
    wheel_radius: float = 0.0375
    track: float = 0.17  # distance between the wheels' contact points
    axle_offset: float = 0.05  # the axle lies this far behind the footprint's centre

    @property
    def half_side(self) -> float:
        """Half the side of the square footprint, m."""
        return self.side / 2

    @property
    def half_diagonal(self) -> float:
        """Radius of the circle around the footprint, m."""
        return self.side * 2**-0.5

    @property
    def sensor_range(self) -> float:
        """Largest distance from the footprint's centre at which a ray sees anything, m."""
        return self.rings[-1]

    @property
    def substeps(self) -> int:
        """Physics steps in one decision period."""
        return round(self.decision_period / self.physics_period)


DEFAULT_ROBOT = RobotSpec()
