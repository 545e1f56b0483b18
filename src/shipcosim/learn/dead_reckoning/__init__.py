"""Dead reckoning of the 82.7 m vessel while GNSS is lost: records, networks of paper II, our filter, regions."""
