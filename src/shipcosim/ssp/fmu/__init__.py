"""FMUs by their modelDescription.xml."""
