"""Simulated against measured, and commanded force against felt: what is grossly wrong."""
