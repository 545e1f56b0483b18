"""Several logs of one ship: fitted together, the reference that logs of the ship being well make, and what changed."""
