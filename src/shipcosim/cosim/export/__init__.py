"""Export of systems: as one FMU, and as files for OSP."""
