"""A monkey at a real window: random mouse, wheel and key events, and what must hold after them."""
