"""What all pages share: colours, units as people read them, pieces of HTML."""
