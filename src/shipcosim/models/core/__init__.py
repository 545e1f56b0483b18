"""Basis of all models: arithmetic of floats, arrays and tensors, kinematics, integration, parameters, tables, sampling."""
