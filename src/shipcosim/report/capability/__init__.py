"""The page of a static DP capability."""
