"""Studies from the command line: run, and from a row to the page of its run."""
