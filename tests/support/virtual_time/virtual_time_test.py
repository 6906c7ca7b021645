#!/usr/bin/env python3
"""Virtual time: programs as they are wait as long as they say, to the microsecond, and take no time for what they do.

Usage, itself in virtual time: virtual_time_test.py RUN_IN_VIRTUAL_TIME LIBRARY
"""

import ctypes
import os
import pty
import select
import signal
import socket
import subprocess
import sys
import threading
import time
import tty
import unittest

KEEPER, LIBRARY = sys.argv[1:3]
C_LIBRARY = ctypes.CDLL(None, use_errno=True)


class Time(ctypes.Structure):
    """struct timespec"""
    _fields_ = [("s", ctypes.c_long), ("ns", ctypes.c_long)]


class Interval(ctypes.Structure):
    """struct itimerspec"""
    _fields_ = [(name, ctypes.c_long) for name in ("again_s", "again_ns", "first_s", "first_ns")]


def microseconds(function, *arguments):
    """Virtual time that a call takes."""
    begin = time.monotonic_ns()
    function(*arguments)
    return (time.monotonic_ns() - begin) // 1000


def python(text, *arguments, **options):
    return subprocess.Popen([sys.executable, "-c", f"import os, select, sys, time\n{text}", *arguments], **options)


class VirtualTime(unittest.TestCase):
    def test_a_wait_takes_as_long_as_it_says_and_no_time_of_the_computer(self):
        self.assertEqual(microseconds(time.sleep, 100 * 3600), 100 * 3600 * 1_000_000)
        self.assertEqual(microseconds(time.sleep, 0.5), 500_000)

    def test_a_thread_that_takes_no_signals_waits_as_others(self):
        waits = []

        def wait():
            signal.pthread_sigmask(signal.SIG_SETMASK, signal.valid_signals())
            for function, *arguments in ((time.sleep, 2), (select.select, [], [], [], 2), (threading.Event().wait, 2)):
                waits.append(microseconds(function, *arguments))

        thread = threading.Thread(target=wait)
        thread.start()
        thread.join()
        self.assertEqual([round(us, -1) for us in waits], [2_000_000] * 3)  # Python rounds up

    def test_both_clocks_go_on_together(self):
        difference = time.time_ns() - time.monotonic_ns()
        time.sleep(86_400)
        self.assertEqual(time.time_ns() - time.monotonic_ns(), difference)

    def test_every_kind_of_wait_ends_in_time(self):
        reader, writer = os.pipe()
        poll = select.poll()
        poll.register(reader, select.POLLIN)
        epoll = select.epoll()
        epoll.register(reader, select.EPOLLIN)
        line, other_end = socket.socketpair()
        line.settimeout(2)

        def wait_for_the_line():
            with self.assertRaises(TimeoutError):
                line.recv(1)

        def wait_for_a_process():
            with self.assertRaises(subprocess.TimeoutExpired):
                process.wait(timeout=2)

        process = python("time.sleep(1000)")
        for function, *arguments in ((poll.poll, 2000), (epoll.poll, 2), (select.select, [reader], [], [], 2),
                                     (threading.Event().wait, 2), (threading.Semaphore(0).acquire, True, 2),
                                     (wait_for_the_line,), (wait_for_a_process,)):
            # Python rounds up.
            self.assertIn(microseconds(function, *arguments), (2_000_000, 2_000_001), function)
        process.kill()
        process.wait()
        epoll.close()
        for end in (line, other_end):
            end.close()
        for end in (reader, writer):
            os.close(end)

    def test_a_timer_descriptor_can_be_read_when_its_time_has_come(self):
        timer = C_LIBRARY.timerfd_create(time.CLOCK_MONOTONIC, os.O_CLOEXEC)
        for wanted_us in (1, 1_500, 3_000_000):
            interval = Interval(0, 0, wanted_us // 1_000_000, wanted_us % 1_000_000 * 1000)
            self.assertEqual(C_LIBRARY.timerfd_settime(timer, 0, ctypes.byref(interval), None), 0)
            self.assertEqual(microseconds(select.select, [timer], [], []), wanted_us)
        os.close(timer)

    def test_a_notification_is_not_lost_that_comes_while_the_waiter_waits_for_the_mutex(self):
        condition, mutex = (ctypes.create_string_buffer(size) for size in (48, 40))  # as PTHREAD_..._INITIALIZER

        def notify():
            C_LIBRARY.pthread_mutex_lock(mutex)
            while time.thread_time() < 0.05:
                pass  # the waiter looks at the time every millisecond of the computer
            C_LIBRARY.pthread_cond_broadcast(condition)
            C_LIBRARY.pthread_mutex_unlock(mutex)

        C_LIBRARY.pthread_mutex_lock(mutex)
        notifier = threading.Thread(target=notify)
        notifier.start()
        until = Time(int(time.monotonic()) + 3600, 0)
        self.assertEqual(microseconds(C_LIBRARY.pthread_cond_clockwait, condition, mutex, time.CLOCK_MONOTONIC, ctypes.byref(until)), 0)
        C_LIBRARY.pthread_mutex_unlock(mutex)
        notifier.join()

    def test_a_program_that_looks_for_events_without_a_pause_lets_time_pass(self):
        end = time.monotonic() + 0.01
        while time.monotonic() < end:
            select.select([], [], [], 0)

    def test_waits_of_several_programs_end_in_their_order(self):
        reader, writer = os.pipe()
        programs = []

        def run():
            for name, seconds in (("c", "30.000002"), ("a", "30"), ("b", "30.000001")):
                programs.append(python("time.sleep(float(sys.argv[1])); os.write(int(sys.argv[2]), sys.argv[3].encode())", seconds,
                                       str(writer), name, pass_fds=[writer]))
            return b"".join(os.read(reader, 1) for _ in range(3))

        # They start at one time, however long each takes to start.
        self.assertEqual(run(), b"abc")
        for program in programs:
            program.wait()
        for end in (reader, writer):
            os.close(end)

    def test_work_takes_no_time(self):
        worker = python("while time.process_time() < 0.3: pass")
        self.assertLessEqual(microseconds(worker.wait, 0.00001), 11)  # Python rounds up

    def test_a_process_that_was_started_a_moment_ago_holds_time_back(self):
        for _ in range(500):
            reader, writer = os.pipe()
            child = os.fork()
            if child == 0:
                while time.process_time() < 0.001:
                    pass
                os._exit(0)  # which closes the pipe
            os.close(writer)
            self.assertEqual(select.select([reader], [], [], 0.000001)[0], [reader])
            os.waitpid(child, 0)
            os.close(reader)

    def test_what_is_sent_arrives_before_time_passes(self):
        echo = "while received := os.read(int(sys.argv[1]), 100): os.write(int(sys.argv[1]), received)"
        for near, far in (socket.socketpair(), pty.openpty(), reversed(pty.openpty())):
            number = far if isinstance(far, int) else far.fileno()
            own = near if isinstance(near, int) else near.fileno()
            for end in (number, own):
                if os.isatty(end):
                    tty.setraw(end)
            program = python(echo, str(number), pass_fds=[number])

            def talk():
                for _ in range(300):
                    os.write(own, b"here")
                    self.assertTrue(select.select([own], [], [], 0.000002)[0])
                    os.read(own, 100)

            with self.subTest(terminal=os.isatty(own)):
                self.assertEqual(microseconds(talk), 0)
            program.kill()
            program.wait()
            for end in (near, far):
                os.close(end) if isinstance(end, int) else end.close()

    def test_a_killed_program_does_not_hold_time_back(self):
        for _ in range(3):
            program = python("time.sleep(1000)")
            time.sleep(0.1)
            program.kill()
            self.assertEqual(microseconds(time.sleep, 5), 5_000_000, "nobody has asked for its status yet")
            program.wait()
            self.assertEqual(microseconds(time.sleep, 5), 5_000_000)

    def test_the_status_is_that_of_the_program_and_waits_without_any_end_are_reported(self):
        environment = {name: value for name, value in os.environ.items() if name not in ("LD_PRELOAD", "PROLEG_VIRTUAL_TIME")}
        for text, status in (("sys.exit(7)", 7), ("time.sleep(1000)", 0), ("select.select([], [], [])", 1)):
            finished = subprocess.run([KEEPER, LIBRARY, sys.executable, "-c", f"import select, sys, time\n{text}"], env=environment,
                                      capture_output=True, text=True)
            self.assertEqual(finished.returncode, status, finished.stderr)
            self.assertEqual("no wait has an end" in finished.stderr, status == 1)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1] + sys.argv[3:])
