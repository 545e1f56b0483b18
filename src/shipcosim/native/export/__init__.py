"""FMUs with models in C: recording of start and step, C text, packing, comparison with Python."""
