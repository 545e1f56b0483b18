"""Our master: plan, instantiation, algorithm, signals, events, time grid, recorder, snapshots."""
