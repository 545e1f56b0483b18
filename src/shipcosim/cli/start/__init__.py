"""Where a user begins: what is there, a project of one's own, new files in it, completion of names."""
