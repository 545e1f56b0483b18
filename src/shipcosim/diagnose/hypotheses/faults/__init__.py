"""Kinds of faults of the log and of the connections, one .toml file each."""
