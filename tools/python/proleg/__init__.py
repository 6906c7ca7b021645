"""Proleg for Python: simulates robots that are chains of joint modules, with the bits of the command line and of the robot.

    import proleg

    scenario = proleg.Scenario("caterpillar")
    scenario["amplitude"] = 30
    run = proleg.simulate(scenario, seconds=10, engine="reduced")
    print(run.displacement, run.measures["cost_of_transport"])

    scores = proleg.evaluate(scenario, ["amplitude", "frequency"], [[30, 0.8], [40, 1.2]])

A name that `proleg scenarios` lists stands for a shipped scenario. Angles are degrees, times seconds, lengths metres. What
cannot be used raises InputError with the line that the command line prints.
"""

import atexit
import os
import weakref
from typing import TYPE_CHECKING

from proleg import _core
from proleg._core import Error, FileError, InputError, RunError, build_id
from proleg.evaluation import Scores, evaluate
from proleg.player import Player
from proleg.recording import Recording, open
from proleg.run import MEASURES, SERIES, Measure, Run, simulate
from proleg.scenario import Parameter, Scenario, caterpillar, shipped, snake
from proleg.worlds import Worlds

if TYPE_CHECKING:
    from proleg.robot import Robot
    from proleg.search import Search

# At the end of Python, calls of daemon threads end first: before what weakref.finalize() closes, so it is set up before them.
weakref.finalize(_core, str)
atexit.register(_core.end_long_calls)
os.register_at_fork(after_in_child=_core.forget_long_calls)

__version__ = build_id.split("-")[0]

__all__ = ["MEASURES", "SERIES", "Error", "FileError", "InputError", "Measure", "Parameter", "Player", "Recording", "Robot", "Run", "RunError", "Scenario",
           "Scores", "Search", "Worlds", "caterpillar", "evaluate", "open", "shipped", "simulate", "snake"]

#: Where names are that few programs need, and whose libraries take longer to load than all others.
_LATER = {"Robot": "proleg.robot", "Search": "proleg.search"}


def __getattr__(name: str) -> object:
    if name in _LATER:
        import importlib

        return getattr(importlib.import_module(_LATER[name]), name)
    raise AttributeError(f"module 'proleg' has no attribute {name!r}")
