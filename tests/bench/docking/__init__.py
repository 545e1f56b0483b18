"""Docking predictors side by side."""
