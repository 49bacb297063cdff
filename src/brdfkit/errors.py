"""The one error of brdfkit that is meant for people."""


class BrdfkitError(ValueError):
    """What is wrong, in which file or parameter, and what to do: one sentence.

    The command line prints it and leaves with status 2; nothing was half-written.
    """
