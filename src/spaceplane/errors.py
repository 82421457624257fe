"""The errors a user can cause. The command line prints them on one line and exits with code 2."""


class InputError(ValueError):
    """Bad input: the message names the field, the value and what is allowed."""
