"""How things look: colours, icons, lengths in words."""
