"""Running instances of FMUs, whatever version and interface type of FMI. The only door to FMPy."""
