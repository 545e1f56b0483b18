"""shipcosim: FMI co-simulation of ships, after the Open Simulation Platform's setup."""

__version__ = "0.1.0"
