"""What one analysis is asked, what it finds at each flight point, and what a reader must know of it."""
