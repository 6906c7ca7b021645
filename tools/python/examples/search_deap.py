"""Searches for a gait with DEAP: its evolution strategy with covariance matrix adaptation, one amplitude for each joint.

Packages: python3-deap.
"""

import numpy as np
import proleg
from deap import base, cma, creator

scenario = proleg.Scenario("caterpillar", engine="reduced")
names = [f"amplitude:{joint}" for joint in scenario.joints] + ["phase_difference"]
lowest, highest = np.array([10.0] * 5 + [30.0]), np.array([60.0] * 5 + [140.0])

np.random.seed(1)
creator.create("Fitness", base.Fitness, weights=(1.0,))
creator.create("Gait", list, fitness=creator.Fitness)
strategy = cma.Strategy(centroid=[0.5] * len(names), sigma=0.3, lambda_=16)


def values(population):
    """The parameters of gaits whose genes are from 0 to 1; genes outside count as the ends."""
    return lowest + np.clip(population, 0, 1) * (highest - lowest)


best, best_score = None, -np.inf
for _ in range(15):
    population = strategy.generate(creator.Gait)
    for gait, score in zip(population, proleg.evaluate(scenario, names, values(population))):
        gait.fitness.values = (score if score == score else -1.0,)  # nan: the simulation failed
        if score > best_score:
            best, best_score = values([gait])[0], score
    strategy.update(population)
own = scenario.replace(engine="ode")
for name, value in zip(names, best):
    own[name] = value
print(f"{best_score:.2f} m found, {proleg.simulate(own).displacement:.2f} m in ODE: {dict(zip(names, best.round(1)))}")
