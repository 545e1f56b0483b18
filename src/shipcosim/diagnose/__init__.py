"""From a measured log to what the simulation gets wrong, its cause by name, an extended system and the gain."""
