"""Prediction of future ship motion."""
