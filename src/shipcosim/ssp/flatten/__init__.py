"""From nested systems to a flat one: components, connections, start values, loops."""
