"""Dynamic positioning: reference model, observer, control law."""
