"""Manoeuvres, and the design of the one that tells causes apart."""
