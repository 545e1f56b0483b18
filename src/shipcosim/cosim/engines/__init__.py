"""Other engines behind one interface: libcosim and ecos."""
