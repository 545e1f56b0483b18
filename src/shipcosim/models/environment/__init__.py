"""Wind, gusts, waves and current, and their loads on a ship."""
