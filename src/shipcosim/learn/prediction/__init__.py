"""Learned prediction: worlds whose truth differs from the predictor's model, and what is learned from them."""
