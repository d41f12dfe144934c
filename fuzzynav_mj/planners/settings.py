"""Margins and weights of the multilayer decision and of its guidance."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class DecisionSettings:
    """One set for all worlds. Lengths in m, times in s, weights in m of progress.

    Attributes:
        static_margin: smallest gap kept to what stands, when creeping ...
        static_margin_growth: ... and per m/s of speed.
        static_recovery: gap to regain where there is less than the margin, per metre travelled ...
        creeping_speed: ... faster than this.
        comfortable_gap: gap to standing obstacles below which a candidate costs more.
        static_weight: cost per metre missing of it.
        moving_margin: smallest gap kept to what moves, now ...
        moving_margin_growth: ... and per second of prediction.
        unlikely_share: share of it that is kept to where movers may be, but are not expected ...
        doubtful: ... unless a speed is as uncertain as this, m/s: then all of it is kept.
        moving_gap: gap to movers below which a candidate costs more, now ...
        moving_gap_growth: ... and per second of prediction, which grows ever less certain ...
        moving_gap_time: ... up to this time.
        moving_weight: cost per metre missing of it, at the worst moment.
        risky_gap: gap to movers, beyond touch, below which contact cannot be ruled out, now ...
        risky_gap_growth: ... and per second of prediction.
        contact_cost: what contact with a mover costs, times how likely it is.
        reverse_cost: what driving backwards costs.
        waiting_cost: what standing still costs where nothing moves.
        change_cost: cost per radian of a new direction of travel.
        passing_time: cost of a way past movers per metre that could be driven in the time it takes,
        passing_length: ... per metre driven on it, and ...
        passing_weight: ... per step and metre missing of the movers' berth on it.
        progress_steps: decision periods after which the progress counts.
        wedged_time: time without leaving a circle of `stuck_radius`, though nothing moves, after
            which the robot goes back to where it came from ...
        stuck_time: ... and, whatever moves, after which it gives up.
        stuck_radius: the circle's radius.
        patience: the same time among movers, after which they count as standing wherever they were
            in the last `trail_time` ...
        impatience: ... for so long, or until the robot is ...
        well_away: ... as far away as this.
        trail_time: memory of movers' hits.
    """

    static_margin: float = 0.015
    static_margin_growth: float = 0.05
    static_recovery: float = 0.15
    creeping_speed: float = 0.2
    comfortable_gap: float = 0.10
    static_weight: float = 1.5
    moving_margin: float = 0.06
    moving_margin_growth: float = 0.03
    unlikely_share: float = 0.5
    doubtful: float = 0.05
    moving_gap: float = 0.13
    moving_gap_growth: float = 0.10
    moving_gap_time: float = 1.0
    moving_weight: float = 0.25
    risky_gap: float = 0.033
    risky_gap_growth: float = 0.11
    contact_cost: float = 1.0
    reverse_cost: float = 0.10
    waiting_cost: float = 0.3
    change_cost: float = 0.02
    passing_time: float = 0.5
    passing_length: float = 0.5
    passing_weight: float = 1.0
    progress_steps: int = 8
    wedged_time: float = 6.0
    stuck_time: float = 45.0
    stuck_radius: float = 0.3
    patience: float = 15.0
    impatience: float = 15.0
    well_away: float = 1.2
    trail_time: float = 2.0


@dataclass(frozen=True, slots=True)
class GuidanceSettings:
    """Widths and gains of the guidance, m.

    Attributes:
        comfortable: half width of a passage that is taken without hesitation.
        tight: half width of the narrowest passage that is taken at all.
        tight_penalty: detour that is preferred to a tight passage.
        blind_penalty: detour that is preferred to going along a wall whose end is not in sight.
        corner: by which two walls that leave sight may be carried on to meet in a closed corner.
        onward: length by which a straight wall that leaves sight is thought to go on.
        search_gain: what a searched way must promise to save before a search is made.
        gain: how much nearer to the goal than all of the boundary a way must lead to leave it.
        turning_gain: how much shorter the way around the other side must look to turn round.
        patience: length of boundary after which a smaller gain will do.
        settling: length after which the robot surely drives along the boundary.
        loop_radius: how near to its start a followed boundary counts as closed.
        loop_length: shortest boundary that can be closed.
    """

    comfortable: float = 0.20
    tight: float = 0.13
    tight_penalty: float = 0.10
    corner: float = 0.5
    onward: float = 1.5
    search_gain: float = 0.15
    blind_penalty: float = 0.3
    gain: float = 0.15
    turning_gain: float = 0.1
    patience: float = 6.0
    settling: float = 0.6
    loop_radius: float = 0.25
    loop_length: float = 1.5
