"""Dockings of paper III: harbours, dockings at them by a simulated helmsman, and what is learned from them."""
