"""Measured logs: read, labelled, repaired."""
