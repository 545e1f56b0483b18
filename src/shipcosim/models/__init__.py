"""Physics, control laws and allocation as pure functions. Knows nothing of FMI or files."""
