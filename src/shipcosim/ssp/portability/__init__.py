"""What other tools make of a system: `check --for`."""
