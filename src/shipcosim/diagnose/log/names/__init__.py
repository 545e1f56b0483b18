"""Names of columns as the field writes them: what they mean, their units, the thrusters that they name."""
