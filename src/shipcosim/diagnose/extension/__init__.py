"""Named causes put into the system: parameter values and structure edits."""
