"""Scenarios: files that describe an arena, its obstacles and the robot's task."""

from fuzzynav_mj.scenarios.loading import library_names, load_scenario

__all__ = ["library_names", "load_scenario"]
