"""Predictors of a drift side by side."""
