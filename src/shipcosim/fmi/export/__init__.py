"""Building FMUs: model description, bundled code, archive. The only door to pythonfmu."""
