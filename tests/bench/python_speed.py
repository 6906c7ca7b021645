#!/usr/bin/env python3
"""What the package for Python takes, as ratios of one run: evaluate() with two workers against one and against the batches of
bench_reduced, Worlds against evaluate().

usage: PYTHONPATH=build/host/python /usr/bin/python3 tests/bench/python_speed.py [CANDIDATES [BENCH_REDUCED]]

BENCH_REDUCED: the program, as build/host/bin/bench_reduced (built with -D PROLEG_BENCHMARKS=ON); without it that ratio is left out.
"""

import subprocess
import sys
import time

begin = time.process_time()
import numpy as np  # noqa: E402

numpy_s = time.process_time() - begin
begin = time.process_time()
import proleg  # noqa: E402

proleg_s = time.process_time() - begin
NAMES, LOWEST, HIGHEST = ["amplitude", "frequency", "phase_difference"], [10, 0.3, 15], [70, 2.2, 140]  # as bench_reduced
WORLDS, TICKS, ROUNDS = 64, 1000, 7


def timed(call):
    """Seconds by the clock, and of the processor."""
    wall, processor = time.monotonic(), time.process_time()
    call()
    return time.monotonic() - wall, time.process_time() - processor


count = int(sys.argv[1]) if len(sys.argv) > 1 else 500
bench_reduced = sys.argv[2] if len(sys.argv) > 2 else None
scenario = proleg.Scenario("caterpillar", engine="reduced")
candidates = np.random.default_rng(1).uniform(LOWEST, HIGHEST, (count, 3))
gait = [40 * np.sin(2 * np.pi * (tick / 100 + np.arange(5) / 4)) for tick in range(TICKS)]
worlds = proleg.Worlds(scenario, n=WORLDS, seconds=TICKS * scenario.tick)


def step_all():
    worlds.reset()
    for setpoints in gait:
        worlds.step(setpoints)


# The speed of a computer changes within seconds. So what is compared takes turns, and a ratio is of neighbours.
rounds = []
for _ in range(ROUNDS):
    two, _ = timed(lambda: proleg.evaluate(scenario, NAMES, candidates, workers=2))
    one, processor = timed(lambda: proleg.evaluate(scenario, NAMES, candidates, workers=1))
    batches = float(subprocess.run([bench_reduced, "--batches", str(count)], stdout=subprocess.PIPE, check=True).stdout) if bench_reduced else 0
    _, evaluated = timed(lambda: proleg.evaluate(scenario, "amplitude", [[40]] * WORLDS, seconds=TICKS * scenario.tick, workers=1))
    _, stepped = timed(step_all)
    rounds.append((count / processor, one / two, 1e6 * stepped / TICKS, stepped / evaluated, processor * batches / count))
speed, workers, tick_us, ratio, to_batches = (f"{np.median(column):.4g} ({min(column):.4g} to {max(column):.4g})" for column in zip(*rounds))

print(f"import: numpy {1000 * numpy_s:.0f} ms of processor, proleg after it {1000 * proleg_s:.0f} ms")
print(f"medians of {ROUNDS} rounds, least and greatest in brackets:")
print(f"evaluate: {speed} evaluations of {scenario.duration:.0f} s in a second of one core; two workers {workers} x one")
if bench_reduced:
    print(f"evaluate: {to_batches} x the time of the batches of bench_reduced")
print(f"Worlds: {tick_us} us of processor for a tick of {WORLDS} worlds, {ratio} x evaluate()")
