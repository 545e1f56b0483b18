"""Constants of nature."""

GRAVITY = 9.81
"""Acceleration of free fall, as manoeuvring and wave formulae take it. [m/s2]"""
