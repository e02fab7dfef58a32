"""Models of OpenSim: read by byte spans, written by splicing."""
