"""What all pages share: frame and parts as templates, colours, units and numbers as people read them."""
