"""What all models are written in: arithmetic for floats, arrays and tensors, frames, parameters, tables, sampling."""
