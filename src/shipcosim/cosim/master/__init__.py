"""Our master: plan, signals, events, time grid, recorder, snapshots."""
