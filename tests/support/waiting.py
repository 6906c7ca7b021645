"""Waits of tests: for what happens, never for a time. The end is only for a test that fails: a computer that has other work to do
may be ten times as slow as an idle one."""

import time

LONGEST = 300  # s, for whatever takes seconds on an idle computer


def wait_until(holds, what="", pause_s=0.05, longest_s=LONGEST):
    """Asks until `holds` returns something true, and returns that. what: a text, or a function that makes it, for the failure."""
    end = time.monotonic() + longest_s
    while not (found := holds()):
        if time.monotonic() > end:
            raise AssertionError(f"not within {longest_s} s: {what() if callable(what) else what}")
        time.sleep(pause_s)
    return found
