"""The ship: hull, motion, sensors and what her instruments show."""
