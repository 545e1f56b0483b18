"""Other methods on the logs of the trial: what the diagnosis is compared with."""
