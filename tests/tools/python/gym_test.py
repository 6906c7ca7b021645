"""proleg.gym keeps the rules of Gymnasium's interface, as its documentation states them (Env, VectorEnv, Box; version 1).

Debian 12 has no gymnasium. Where it is installed, its own checker runs, too.
"""

import inspect
import os
import unittest

import numpy as np
import proleg
import proleg.gym
from proleg.gym import Env, VectorEnv

try:
    from gymnasium.utils.env_checker import check_env
except ImportError:
    check_env = None


def wave(tick, joints=5):
    return np.array([40 * np.sin(tick / 8 + k) for k in range(joints)], dtype=np.float32)


def episode(env, seed, options=None):
    """All that an environment gives in an episode."""
    steps = [env.reset(seed=seed, options=options)]
    while True:
        steps.append(env.step(wave(len(steps))))
        if np.all(steps[-1][2]) or np.all(steps[-1][3]):
            return steps


class Rules(unittest.TestCase):
    def setUp(self):
        self.env = Env("caterpillar", seconds=0.3)

    def test_of_reset(self):
        parameters = inspect.signature(Env.reset).parameters
        self.assertEqual((parameters["seed"].kind, parameters["seed"].default), (inspect.Parameter.KEYWORD_ONLY, None))
        self.assertEqual((parameters["options"].kind, parameters["options"].default), (inspect.Parameter.KEYWORD_ONLY, None))
        for result in (self.env.reset(), self.env.reset(seed=3), self.env.reset(seed=3, options={})):
            observation, info = result
            self.assertIn(observation, self.env.observation_space)
            self.assertEqual(observation.dtype, self.env.observation_space.dtype)
            self.assertIsInstance(info, dict)

    def test_of_step(self):
        self.env.reset(seed=1)
        observation, reward, terminated, truncated, info = self.env.step(self.env.action_space.sample())
        self.assertIn(observation, self.env.observation_space)
        self.assertIsInstance(reward, float)
        self.assertTrue(np.isfinite(reward))
        self.assertIs(terminated, False)
        self.assertIs(truncated, False)
        self.assertIsInstance(info, dict)

    def test_of_spaces(self):
        for space in (self.env.action_space, self.env.observation_space):
            space.seed(1)
            first = [space.sample() for _ in range(20)]
            space.seed(1)
            for drawn, again in zip(first, (space.sample() for _ in range(20))):
                self.assertIn(drawn, space)
                self.assertEqual((drawn.dtype, drawn.shape), (space.dtype, space.shape))
                np.testing.assert_array_equal(drawn, again)
            self.assertTrue(np.all(space.low < space.high))
        action = self.env.action_space
        self.assertNotIn(np.full(5, 90.1, np.float32), action)
        self.assertNotIn(np.zeros(4, np.float32), action)
        self.assertNotIn(np.full(5, np.nan, np.float32), action)
        self.assertEqual(self.env.observation_space.shape, (len(self.env.observation_names),))

    def test_of_observations_hold_in_random_episodes(self):
        for _ in range(3):
            self.env.reset()
            truncated = False
            while not truncated:
                observation, _, terminated, truncated, _ = self.env.step(self.env.action_space.sample())
                self.assertIn(observation, self.env.observation_space)
                self.assertFalse(terminated)

    def test_of_the_end(self):
        """Truncated at the end of the time, and not terminated; no step after it."""
        steps = episode(self.env, 1)
        self.assertEqual([step[2:4] for step in steps[1:]], [(False, False)] * 29 + [(False, True)])
        with self.assertRaisesRegex(proleg.InputError, "reset"):
            self.env.step(wave(0))
        self.env.reset()
        self.env.step(wave(0))

    def test_of_seeds(self):
        """Equal seeds give equal episodes, also those that follow without a seed."""
        def episodes(env):
            return [episode(env, 7), episode(env, None), episode(env, None)]

        noisy = "adaptive_touch_level"
        one, other = episodes(Env(noisy, seconds=0.2, engine=None)), episodes(Env(noisy, seconds=0.2, engine=None))
        for first, second in zip(one, other):
            for left, right in zip(first, second):
                np.testing.assert_array_equal(left[0], right[0])
                self.assertEqual(left[1:], right[1:])

    def test_of_objects(self):
        with self.env as env:
            self.assertIs(env.unwrapped, env)
            self.assertIsNone(env.render_mode)
            self.assertEqual(env.metadata["render_modes"], [])
        self.env.close()

    @unittest.skipIf(check_env is None, "gymnasium is not installed")
    def test_of_gymnasium_itself(self):
        check_env(self.env, skip_render_check=True)


class Worlds(unittest.TestCase):
    def test_are_those_of_the_package(self):
        """A run by Worlds has the same numbers."""
        env = Env("caterpillar", seconds=0.3)
        steps = episode(env, 5, {"setpoints": wave(0)})
        worlds = proleg.Worlds("caterpillar", seconds=0.3)
        worlds.reset(setpoints=wave(0))
        total = 0.0
        for tick in range(1, 31):
            observation, reward, _, _ = worlds.step(wave(tick)[None])
            np.testing.assert_array_equal(observation[0], steps[tick][0])
            self.assertEqual(reward[0], steps[tick][1])
            total += steps[tick][1]
        self.assertNotEqual(total, 0)

    def test_of_a_vector_are_each_an_env(self):
        vector = VectorEnv("caterpillar", 3, seconds=0.3)
        self.assertEqual(vector.num_envs, 3)
        self.assertEqual(vector.single_observation_space.shape, (vector.observation_space.shape[1],))
        self.assertEqual(vector.action_space.shape, (3, 5))
        self.assertIn(vector.reset(seed=1)[0], vector.observation_space)
        one = Env("caterpillar", seconds=0.3)
        one.reset(seed=1)
        for tick in range(30):
            actions = np.stack([wave(tick), wave(tick) / 2, -wave(tick)])
            self.assertIn(actions, vector.action_space)
            observation, reward, terminated, truncated, info = vector.step(actions)
            alone = one.step(actions[0])
            np.testing.assert_array_equal(observation[0], alone[0])
            self.assertEqual(reward[0], alone[1])
            self.assertEqual((reward.shape, terminated.dtype, truncated.dtype), ((3,), np.bool_, np.bool_))
            self.assertEqual((terminated.tolist(), truncated.tolist()), ([False] * 3, [tick == 29] * 3))
        self.assertEqual(info, {"failure": ["", "", ""]})
        vector.reset(options={"reset_mask": np.ones(3, bool)})
        with self.assertRaises(proleg.InputError):
            vector.reset(options={"reset_mask": np.array([True, False, True])})


class AChildOfFork(unittest.TestCase):
    def drawn(self, prepare):
        """What the parent and two children draw next, after a reset and for an action."""
        env = Env("caterpillar", seconds=0.1)
        prepare(env)
        found = []
        for _ in range(2):
            end, begin = os.pipe()
            child = os.fork()
            if child == 0:
                env.reset()
                os.write(begin, np.concatenate([[env._episodes._chance.integers(2**52)], env.action_space.sample()]).astype(np.float64).tobytes())
                os._exit(0)
            os.waitpid(child, 0)
            found.append(os.read(end, 1000))
        return found

    def test_has_random_numbers_of_its_own(self):
        one, other = self.drawn(lambda env: env.reset())
        self.assertNotEqual(one[:8], other[:8])
        if proleg.gym._Space is proleg.gym._Box:
            self.assertNotEqual(one[8:], other[8:])

    def test_goes_on_with_a_seed(self):
        one, other = self.drawn(lambda env: (env.reset(seed=3), env.action_space.seed(4)))
        self.assertEqual(one, other)


class Failures(unittest.TestCase):
    def test_terminate_an_episode(self):
        """Of one world: the others go on. The worlds are stand-ins, because no robot of these falls apart."""
        class Failing:
            n, joints = 2, ["J1"]

            def reset(self, seed, setpoints):
                return np.zeros((2, 1))

            def step(self, action):
                return np.zeros((2, 1)), np.zeros(2), np.array([True, False]), {"failures": ["it flew off", ""]}

        vector = VectorEnv("caterpillar", 2)
        vector._episodes = proleg.gym._Episodes(Failing())
        vector.reset()
        _, _, terminated, truncated, info = vector.step(np.zeros((2, 1)))
        self.assertEqual((terminated.tolist(), truncated.tolist(), info["failure"][0]), ([True, False], [False, False], "it flew off"))
        vector.step(np.zeros((2, 1)))


class WhatCannotBeUsed(unittest.TestCase):
    def test_raises_input_error(self):
        env = Env("caterpillar", seconds=1)
        with self.assertRaisesRegex(proleg.InputError, "reset"):
            env.step(wave(0))
        env.reset()
        for what, action in {
            "a shape": lambda: env.step(np.zeros(4)),
            "nan": lambda: env.step(np.full(5, np.nan)),
            "a text": lambda: env.step("left"),
            "a seed": lambda: env.reset(seed=-1),
            "a seed that is no number": lambda: env.reset(seed="1"),
            "an option": lambda: env.reset(options={"velocity": 3}),
            "options that are none": lambda: env.reset(options=3),
            "options of many kinds": lambda: env.reset(options={1: 2, "a": 3}),
            "a seed that is a time": lambda: env.reset(seed=np.timedelta64(1, "s")),
            "a mask": lambda: env.step(np.ma.array(wave(0), mask=[0, 1, 0, 0, 0])),
            "a set": lambda: env.step({1, 2, 3, 4, 5}),
            "a start": lambda: env.reset(options={"setpoints": np.zeros(3)}),
            "a scenario": lambda: Env("nothing"),
            "no worlds": lambda: VectorEnv("caterpillar", 0),
        }.items():
            with self.subTest(what), self.assertRaises(proleg.InputError):
                action()
        env.step(wave(0))


if __name__ == "__main__":
    unittest.main()
