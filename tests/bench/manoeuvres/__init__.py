"""What manoeuvres show."""
