"""Sea trials: what straight runs, circles and zig-zags of a log say of the ship model, without the log's clock."""
