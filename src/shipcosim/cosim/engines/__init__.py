"""Engines of others behind the same call: libcosim and ecos."""
