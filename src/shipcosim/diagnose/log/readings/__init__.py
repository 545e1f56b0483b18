"""How the channels of a log are to be read, judged jointly by all kinematic relations between them."""
