"""A model of OpenSim as a study: bodies, their sessions, and the model that comes of them."""
