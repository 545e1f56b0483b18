"""Instances of FMUs of all FMI versions and interface types. Only this package uses FMPy."""
