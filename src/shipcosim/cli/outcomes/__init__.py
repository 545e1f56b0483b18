"""How commands end: exit codes, JSON, JUnit, the summary of a step on GitHub. One way for all commands."""
