"""Exact solutions of the flow of a perfect gas, for methods and validation alike."""
