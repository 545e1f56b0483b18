"""What is not known of a ship, from published formulae, each with its source and a tolerance."""
