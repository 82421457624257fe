"""Why to trust it: published cases."""
