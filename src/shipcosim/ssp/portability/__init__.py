"""Checks of a system for other tools that read its file themselves: `check --for`."""
