"""A craft learned from her logs: a few numbers of her thrust, inertia, damping and coupling, and what each gains."""
