"""Learns a policy that crosses a terrace by touch: the cross-entropy method, an evolution strategy, in numpy.

The policy gives the set-points of every tick: a travelling wave, and for each joint a weighted sum of what the front touch
sensors near it have felt in the last tenths of a second, and of the slope of the head. A wave alone stays at the first step.
"""

import numpy as np
import proleg

SECONDS, POPULATION, ELITE, GENERATIONS = 25, 64, 10, 12
TERRACE_END = 1.7  # m, along y; it is 1.2 m long, 60 mm high, and begins 0.18 m before the head
REACH = 2  # touch sensors of so many links to each side of a joint

worlds = proleg.Worlds("terrace", n=POPULATION, seconds=SECONDS)
names = list(worlds.observation_names)
front = [i for i, name in enumerate(names) if name.startswith("contact_front.")]
joints = len(worlds.joints)


def policy_parts(genes):
    """genes: (n, 4 + 2 REACH + 1). Amplitude and phase difference in degrees, frequency in Hz, weights in degrees."""
    amplitude = 45 + 10 * genes[:, 0]
    frequency = np.clip(1.0 + 0.2 * genes[:, 1], 0.2, 2)
    difference = 75 + 15 * genes[:, 2]
    return amplitude, frequency, difference, 20 * genes[:, 3], 15 * genes[:, 4:]


def play(genes):
    """Metres forward of each policy in an episode."""
    amplitude, frequency, difference, lift, weights = policy_parts(genes)
    observation = worlds.reset(seed=1)
    felt = np.zeros((POPULATION, joints + 1))
    score = np.zeros(POPULATION)
    order = np.arange(joints)
    tick, done = 0, np.zeros(POPULATION, dtype=bool)
    while not done.all():
        felt = 0.95 * felt + 0.05 * observation[:, front]
        padded = np.pad(felt, ((0, 0), (REACH, REACH)))
        touch = sum(weights[:, [k]] * padded[:, k:k + joints] for k in range(2 * REACH + 1))
        wave = amplitude[:, None] * np.sin(2 * np.pi * (frequency[:, None] * tick * worlds.tick + difference[:, None] / 360 * order))
        nose = lift[:, None] * felt[:, :1] * (order == 0)
        observation, reward, done, _ = worlds.step(np.clip(wave + touch + nose, -90, 90))
        score += reward
        tick += 1
    return score


def main():
    chance = np.random.default_rng(1)
    mean, spread = np.zeros(4 + 2 * REACH + 1), np.ones(4 + 2 * REACH + 1)
    best, best_score = mean, -np.inf
    for generation in range(GENERATIONS):
        genes = mean + spread * chance.standard_normal((POPULATION, len(mean)))
        genes[0] = mean
        score = play(genes)
        elite = genes[np.argsort(-score)[:ELITE]]
        mean, spread = elite.mean(axis=0), 0.9 * elite.std(axis=0) + 0.05
        if score.max() > best_score:
            best, best_score = genes[score.argmax()], score.max()
        print(f"generation {generation:2}: best {score.max():.2f} m, mean of all {score.mean():.2f} m", flush=True)
    play(np.tile(best, (POPULATION, 1)))
    tail = worlds.positions[0, :, 1].min()
    print(f"{best_score:.2f} m in {SECONDS} s; the last link is {tail - TERRACE_END:.2f} m behind the terrace")
    return best


if __name__ == "__main__":
    main()
