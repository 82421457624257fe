"""How it is held: controllability, stabilising feedback, and whether the control surfaces suffice."""
