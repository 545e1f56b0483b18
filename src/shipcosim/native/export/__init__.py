"""FMUs with the models in C: start and step recorded on symbols, C text, packing, and the comparison with Python."""
