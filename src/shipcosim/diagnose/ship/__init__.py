"""The ship model in array form, her inputs, tolerances and third-party FMUs."""
