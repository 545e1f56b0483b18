"""System structures changed and written."""
