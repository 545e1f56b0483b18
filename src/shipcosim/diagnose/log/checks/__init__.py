"""Faults of a log that show in the log itself."""
