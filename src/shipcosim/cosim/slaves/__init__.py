"""Running instances of FMUs, whatever version and form of FMI. The only door to FMPy."""
