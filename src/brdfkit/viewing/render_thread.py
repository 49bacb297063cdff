"""`RenderThread`: one thread that renders the pictures of all sessions, in turn."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable

from brdfkit.viewing.application import Message
from brdfkit.viewing.pictures import describe_error
from brdfkit.viewing.session import Session

Send = Callable[[Message], None]  # hands a message to a page; it must not wait for the page

NAME = "brdfkit view"  # of the threads
LONGEST_END = 0.3  # seconds for which the end waits
IDLE = 0.5  # seconds after which the thread looks for work without being woken


class RenderThread:
    """Renders the sessions that have work, one pass each in turn, until it is stopped."""

    def __init__(self) -> None:
        self.sessions: dict[Session, Send] = {}
        self.changed = threading.Condition()
        self.stopped = False
        self.thread = threading.Thread(target=self._run, name=NAME, daemon=True)
        self.thread.start()

    def add(self, session: Session, send: Send) -> None:
        """Render a session, and hand its pictures to `send`."""
        with self.changed:
            self.sessions[session] = send
            self.changed.notify()

    def remove(self, session: Session) -> None:
        """Stop to render a session, because nobody looks any more."""
        with self.changed:
            self.sessions.pop(session, None)

    def wake(self) -> None:
        """Look for work now, after a message."""
        with self.changed:
            self.changed.notify()

    def stop(self) -> None:
        """End the thread after the pass that it renders, for which this waits only shortly.

        The files of the pages are deleted.
        """
        with self.changed:
            self.stopped, sessions = True, list(self.sessions)
            self.changed.notify()
        closing = [threading.Thread(target=s.close, daemon=True) for s in sessions]
        for thread in closing:  # of which one may wait for a long answer
            thread.start()
        end = time.monotonic() + LONGEST_END
        for thread in (*closing, self.thread):
            thread.join(max(end - time.monotonic(), 0))

    def _run(self) -> None:
        while not self.stopped:
            with self.changed:
                waiting = [(s, send) for s, send in self.sessions.items() if s.has_work()]
                if not waiting:
                    self.changed.wait(IDLE)
                    continue
            for session, send in waiting:
                for message in work_safely(session):
                    send(message)


def is_rendering() -> bool:
    """Return whether a thread that was told to stop still renders."""
    return any(thread.name == NAME for thread in threading.enumerate())


def work_safely(session: Session) -> list[Message]:
    """Return the messages of a pass; an error becomes a message, and pauses the view."""
    try:
        return session.work()
    except Exception as error:  # a defect of ours must not end the thread in silence
        with session.lock:
            session.paused = True
        return [describe_error(error), session.describe_progress()]
