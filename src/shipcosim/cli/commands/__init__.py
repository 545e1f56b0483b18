"""Commands, one file each: the arguments, and the calls in order."""
