"""Prediction of the motion to come."""
