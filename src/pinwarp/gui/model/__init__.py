"""A model of OpenSim in the window: its bodies, what stands on them, and the model that leaves."""
