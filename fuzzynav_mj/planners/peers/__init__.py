"""Planners to compare with: simple floors, and well-known methods under the same limits."""
