"""Searches for a gait with SciPy: differential evolution over the amplitude and phase difference of a travelling wave.

Packages: python3-scipy. Each generation is one call, so that the engine computes its candidates together.
"""

import proleg
from scipy.optimize import differential_evolution

scenario = proleg.Scenario("caterpillar", engine="reduced")
names = ["amplitude", "phase_difference"]


def distances(candidates):
    """candidates: (parameters, n), as SciPy gives them. What is minimised: the distance, negative, in m."""
    scores = proleg.evaluate(scenario, names, candidates.T)
    return [-score if score == score else 0.0 for score in scores]  # a run that failed has the score nan


found = differential_evolution(distances, [(10, 60), (30, 140)], popsize=12, maxiter=8, seed=1, polish=False,
                               vectorized=True, updating="deferred")
best = scenario.replace(engine="ode")
for name, value in zip(names, found.x):
    best[name] = value
print(f"{proleg.evaluate(scenario, names, [[40, 90]])[0]:.2f} m at first")
print(f"{-found.fun:.2f} m found, {proleg.simulate(best).displacement:.2f} m in ODE: {dict(zip(names, found.x.round(1)))}")
