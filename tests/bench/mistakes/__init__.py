"""Ordinary mistakes in logs, drawn: how often what is said of the data is right, wrong, or left open."""
