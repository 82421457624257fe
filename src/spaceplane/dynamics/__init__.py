"""How it moves: frames, equations of motion, linearisation, modes."""
