"""The ship: hull, equations of motion, sensors, errors of instruments."""
