"""Thrusters: drive, propeller, slipstream, thrust."""
