"""What a named cause is worth: predictions on data that nothing was fitted to."""
