"""Faults of a log that only the ship's answer tells."""
