"""The air around the vehicle: octree and cut cells."""
