#!/usr/bin/env python3
"""What the package for Python takes, as ratios of one run: evaluate() with two workers against one, Worlds against evaluate().

usage: PYTHONPATH=build/host/python /usr/bin/python3 tests/bench/python_speed.py [CANDIDATES]

Compare evaluations a second of one core with "batches of 64" of bench_reduced, beside nothing else.
"""

import sys
import time

begin = time.process_time()
import numpy as np  # noqa: E402

numpy_s = time.process_time() - begin
begin = time.process_time()
import proleg  # noqa: E402

proleg_s = time.process_time() - begin
NAMES, LOWEST, HIGHEST = ["amplitude", "frequency", "phase_difference"], [10, 0.3, 15], [70, 2.2, 140]  # as bench_reduced
WORLDS, TICKS = 64, 1000


def timed(call):
    """Seconds by the clock, and of the processor."""
    wall, processor = time.monotonic(), time.process_time()
    call()
    return time.monotonic() - wall, time.process_time() - processor


count = int(sys.argv[1]) if len(sys.argv) > 1 else 1000
scenario = proleg.Scenario("caterpillar", engine="reduced")
candidates = np.random.default_rng(1).uniform(LOWEST, HIGHEST, (count, 3))
one, processor = timed(lambda: proleg.evaluate(scenario, NAMES, candidates, workers=1))
two, _ = timed(lambda: proleg.evaluate(scenario, NAMES, candidates, workers=2))

gait = [40 * np.sin(2 * np.pi * (tick / 100 + np.arange(5) / 4)) for tick in range(TICKS)]
worlds = proleg.Worlds(scenario, n=WORLDS, seconds=TICKS * scenario.tick)
worlds.reset()
_, stepped = timed(lambda: [worlds.step(setpoints) for setpoints in gait])
_, evaluated = timed(lambda: proleg.evaluate(scenario, "amplitude", [[40]] * WORLDS, seconds=TICKS * scenario.tick, workers=1))

print(f"import: numpy {1000 * numpy_s:.0f} ms of processor, proleg after it {1000 * proleg_s:.0f} ms")
print(f"evaluate: {count / processor:.1f} evaluations of {scenario.duration:.0f} s in a second of one core; two workers {one / two:.2f} x one")
print(f"Worlds: {1e6 * stepped / TICKS:.0f} us of processor for a tick of {WORLDS} worlds, {stepped / evaluated:.2f} x evaluate()")
