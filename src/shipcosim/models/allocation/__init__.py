"""Thrust allocation."""
