"""Simulated against measured, and commanded against measured force: what is grossly wrong."""
