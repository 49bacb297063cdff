"""What Ctrl-C raises within a search."""


class Stopped(KeyboardInterrupt):
    """Ctrl-C ended a search; `best`: what it had come to."""

    def __init__(self, best):
        super().__init__("interrupted")
        self.best = best
