"""SSP files as written: structure, parameter sets, mappings, dictionaries."""
