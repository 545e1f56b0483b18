"""System structures edited and written."""
