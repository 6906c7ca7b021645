"""Searches for a gait with Optuna: its tree-structured Parzen estimator proposes candidates in small batches.

Packages: python3-optuna.
"""

import optuna
import proleg

scenario = proleg.Scenario("caterpillar", engine="reduced")
names = ["amplitude", "phase_difference"]

optuna.logging.set_verbosity(optuna.logging.WARNING)
study = optuna.create_study(direction="maximize", sampler=optuna.samplers.TPESampler(seed=1))
for _ in range(10):
    trials = [study.ask() for _ in range(16)]
    candidates = [[trial.suggest_float("amplitude", 10, 60), trial.suggest_float("phase_difference", 30, 140)] for trial in trials]
    for trial, score in zip(trials, proleg.evaluate(scenario, names, candidates)):
        if score == score:
            study.tell(trial, score)
        else:  # nan: the simulation failed
            study.tell(trial, state=optuna.trial.TrialState.FAIL)
best = scenario.replace(engine="ode")
for name, value in study.best_params.items():
    best[name] = value
print(f"{study.best_value:.2f} m found, {proleg.simulate(best).displacement:.2f} m in ODE: {study.best_params}")
