"""Systems exported: as one FMU, and as files for OSP."""
