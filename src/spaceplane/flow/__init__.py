"""What the air does: the compressible Euler ensemble solver."""
