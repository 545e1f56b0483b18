"""The page of a diagnosis of several logs."""
