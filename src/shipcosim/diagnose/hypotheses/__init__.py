"""The catalogue of causes: one .toml file each, and what reads them."""
