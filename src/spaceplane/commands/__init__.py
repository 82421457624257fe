"""One module a command; heavy packages load inside the functions, so that `spaceplane --help` is quick."""
