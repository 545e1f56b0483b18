"""What results show in a notebook: a card in HTML, and pictures in SVG that need no script and no network."""
