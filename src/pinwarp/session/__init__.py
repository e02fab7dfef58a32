"""The application without a screen: what one works on, every way to change it, and what follows."""
