"""Self-tests of judges: questions with one right answer, and beliefs that are changed for a while."""

import contextlib
from collections.abc import Iterator


class Trial:
    """Counts what is not as it must be, and says all."""

    def __init__(self) -> None:
        self.failed = 0

    def ask(self, good: object, text: str) -> None:
        self.failed += not good
        print(f"{'ok  ' if good else 'FAIL'} {text}", flush=True)

    def status(self) -> int:
        print(f"self-test: {f'{self.failed} failed' if self.failed else 'all as it must be'}")
        return int(self.failed > 0)


@contextlib.contextmanager
def belief(holder: object, name: str, value: object) -> Iterator[None]:
    """An attribute of a module or of an object has another value meanwhile."""
    was = getattr(holder, name)
    setattr(holder, name, value)
    try:
        yield
    finally:
        setattr(holder, name, was)
