"""Causes: faults of the ship and what surrounds her, one file each with all that is particular to it."""
