"""The page of sea trials."""
