#!/usr/bin/env python3
"""Slow time: each wait of a program takes so many times as long, and its own clock says that it did not.

Usage, with the library loaded: slow_time_test.py
"""

import ctypes
import os
import select
import socket
import subprocess
import sys
import threading
import time
import unittest

SLOWNESS = int(os.environ["PROLEG_SLOW_TIME"])
C_LIBRARY = ctypes.CDLL(None, use_errno=True)
WAIT_S = 0.02


class Time(ctypes.Structure):
    """struct timespec"""
    _fields_ = [(name, ctypes.c_long) for name in ("s", "ns")]


class Interval(ctypes.Structure):
    """struct itimerspec"""
    _fields_ = [("again", Time), ("first", Time)]


def time_of(seconds):
    return Time(int(seconds), int(seconds % 1 * 1e9))


def wait_for_a_timer(flags, end):
    timer = C_LIBRARY.timerfd_create(time.CLOCK_MONOTONIC, os.O_CLOEXEC)
    interval = Interval(Time(0, 0), time_of(end))
    assert C_LIBRARY.timerfd_settime(timer, flags, ctypes.byref(interval), None) == 0
    os.read(timer, 8)
    os.close(timer)


def wait_for_a_duration(seconds):
    wait_for_a_timer(0, seconds)


def wait_for_a_time(seconds):
    absolute = 1
    wait_for_a_timer(absolute, time.monotonic() + seconds)


def wait_for_a_condition(seconds):
    """As std::condition_variable waits for a time of std::chrono::steady_clock."""
    condition, mutex = (ctypes.create_string_buffer(size) for size in (48, 40))  # both as PTHREAD_..._INITIALIZER
    C_LIBRARY.pthread_mutex_lock(mutex)
    until = time_of(time.monotonic() + seconds)
    C_LIBRARY.pthread_cond_clockwait(condition, mutex, time.CLOCK_MONOTONIC, ctypes.byref(until))
    C_LIBRARY.pthread_mutex_unlock(mutex)


def wait_for_a_lock(seconds):
    threading.Event().wait(seconds)


class SlowTime(unittest.TestCase):
    def test_every_kind_of_wait_is_so_many_times_as_long_on_the_computers_calendar(self):
        reader, writer = os.pipe()
        poll = select.poll()
        poll.register(reader, select.POLLIN)
        epoll = select.epoll()
        epoll.register(reader, select.EPOLLIN)
        line, other_end = socket.socketpair()
        line.settimeout(WAIT_S)

        def wait_for_the_line():
            with self.assertRaises(TimeoutError):
                line.recv(1)

        for function, *arguments in ((time.sleep, WAIT_S), (poll.poll, WAIT_S * 1000), (epoll.poll, WAIT_S),
                                     (select.select, [reader], [], [], WAIT_S), (wait_for_the_line,),
                                     (wait_for_a_duration, WAIT_S), (wait_for_a_time, WAIT_S), (wait_for_a_condition, WAIT_S), (wait_for_a_lock, WAIT_S)):
            with self.subTest(wait=function.__name__):
                begin, calendar = time.monotonic_ns(), time.time_ns()
                function(*arguments)
                own, computers = time.monotonic_ns() - begin, time.time_ns() - calendar
                # A busy computer may make it longer. The steps of the clocks are less than a millisecond.
                self.assertGreaterEqual(own, WAIT_S * 1e9 - 1e6)
                self.assertGreaterEqual(computers, WAIT_S * SLOWNESS * 1e9 - 1e6)
        epoll.close()
        for end in (line, other_end):
            end.close()
        for end in (reader, writer):
            os.close(end)

    def test_all_programs_have_the_same_clock(self):
        begin = time.monotonic_ns()
        child = subprocess.run([sys.executable, "-c", "import time; print(time.monotonic_ns())"], capture_output=True, text=True)
        self.assertLessEqual(begin, int(child.stdout))
        self.assertLessEqual(int(child.stdout), time.monotonic_ns())


if __name__ == "__main__":
    unittest.main()
