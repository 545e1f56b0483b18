"""Linearisation, Kalman filter, noise, evidence, fitting, search and verdict."""
