"""How it handles: military flying-quality criteria."""
