"""Scenarios: files that describe an arena, its obstacles and the robot's task."""

from fuzzynav_mj.scenarios.loading import library_names, load_scenario

__all__ = ["PAPER_SCENARIOS", "library_names", "load_scenario"]

PAPER_SCENARIOS = ("concave", "convex", "maze", "narrow")  # the library's others are single hazards
