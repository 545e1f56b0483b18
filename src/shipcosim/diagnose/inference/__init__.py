"""Linearisation, Kalman filter, noise, evidence, fitting, open-loop predictions."""
