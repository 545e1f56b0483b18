"""Which causes explain a log: sets of causes sought and fitted, the form of the ship, the verdict."""
