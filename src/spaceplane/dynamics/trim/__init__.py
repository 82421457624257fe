"""Deflections and attitudes that balance the moments, within limits, or the reason why there are none."""
