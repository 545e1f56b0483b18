"""Basis of all models: arithmetic, interpolation, kinematics, integration, parameters, tables, sampling."""
