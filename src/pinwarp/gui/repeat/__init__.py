"""How precise the landmarks are, from sets of them that were digitised again."""
