"""The first guess: every landmark proposed on the destination, to be accepted one by one."""
