"""An aerodynamic model of a vehicle from its own flow: which conditions, each shape's flow, and the tables of them."""
