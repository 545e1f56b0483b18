"""OspSystemStructure.xml, read and written."""
