"""phihat's worlds as environments for learning, with the interface of Gymnasium (``pip install 'phihat[gym]'``).

>>> from phihat.gym import Env, VectorEnv
>>> env = Env("studies/first.toml", action="correction")
>>> observation, info = env.reset(seed=7)
>>> observation, reward, terminated, truncated, info = env.step(env.action_space.sample())

An episode is a run of a study: friction, payload, encoders, filter, delay, losses, faults, limits of torque and its rate are
those of the study, as they are under phihat's own law. Its end is the study's (``truncated``); an arm that leaves every
plausible state, or that the robot's interface stops, ends it before (``terminated``).

**Observation**: ``[q, dq, tau_applied, q_des, dq_des, ddq_des]`` of all joints, shape ``(6 n,)``, SI units and radians: what a law
sees at a sample, through encoder, filter and delay; not what is true.

**Action**: ``"torque"``, a torque per joint [N m]; or ``"correction"``, what is added to the torque of phihat's own law, which then runs
with the gains given, or those that the study states or leaves to the design. The study's limits act on the sum. An action
holds for ``repeat`` samples.

**Reward** of a step, unless one is given: ``-mean((q - q_des)² / bound²) - action_cost · mean(action² / action_max²)``, means over
joints, with the positions that are sensed after it, and ``bound`` the study's ``error_bound_rad``, else 1 mrad. The step in which
an episode is terminated has the reward ``failure``.

**Seeds**: ``reset(seed=…)`` seeds the environment's generator, which draws the seed of every episode's study, told as
``info["seed"]``, and then what ``randomise`` names, in its order; ``options={"seed": …, "values": {key: number}}`` states them for one
episode. The same seeds and actions give the same bits.

**Precision**: the worlds are those of ``phihat run``, in double precision. ``dtype="float32"`` hands out observations, and takes actions, in
single precision, as networks do: rounded on the way, and so no longer the bits of a run in double precision.

**Records**: every episode keeps all of its signals for ``trace``, some 120 bytes for a joint and a sample. ``record=False`` keeps none, and is faster.

Not claimed: nothing is certified about what was learnt.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from . import _phihat
from ._document import Study, source
from ._errors import ArgumentError, Error
from ._rollouts import ALIASES
from .trace import Trace

try:
    import gymnasium
    from gymnasium.utils import seeding
    from gymnasium.vector import AutoresetMode
    from gymnasium.vector.utils import batch_space
except ImportError as _why:
    raise Error("gymnasium is missing: pip install 'phihat[gym]'") from _why

__all__ = ["Env", "VectorEnv"]

_Array = NDArray[np.float64]
_Seen = NDArray[Any]
"""Of the ``dtype`` that was asked for."""

Reward = Callable[[_Array, _Array], _Array]
"""Rewards of a step from observations after it and actions, one row per environment: ``(N, 6 n), (N, n)`` to ``(N,)``."""

_RUNS, _AT_ITS_END = 0, 1


class _Core:
    """Many worlds of one study, and what a step in them is worth."""

    def __init__(
        self,
        study: Study,
        count: int,
        *,
        action: Literal["torque", "correction"] = "torque",
        gains: _phihat.Gains | None = None,
        action_max: float | _Array | None = None,
        repeat: int = 1,
        randomise: Mapping[str, tuple[float, float]] | None = None,
        reward: Reward | None = None,
        action_cost: float = 0.0,
        failure: float = -1000.0,
        dtype: Literal["float32", "float64"] = "float64",
        record: bool = True,
        name: str = "python",
    ) -> None:
        if dtype not in ("float32", "float64"):
            raise _refused("dtype", dtype, "'float32' or 'float64'")
        if not isinstance(record, bool):
            raise _refused("record", record, "True or False")
        if action not in ("torque", "correction"):
            raise _refused("action", action, "'torque' or 'correction'")
        if isinstance(repeat, bool) or not isinstance(repeat, int) or not 1 <= repeat <= 100_000:
            raise _refused("repeat", repeat, "an integer from 1 to 100000")
        path, document = source(study)
        if action == "correction" and gains is None:
            # Those that a simulation of the study would choose.
            chosen = {"path": path, "document": document, "name": name, "numbers": [], "seeds": [0], "runs": 1}
            gains = _phihat.Rollouts({**chosen, "gains": None, "uncertified": False}).gains
        self.worlds = _phihat.Worlds(path, document, name, count, gains, (action == "correction", record))
        self.joints = len(self.worlds.joint_names)
        limits = self.worlds.torque_max if action_max is None else action_max
        most = np.broadcast_to(np.asarray(limits, dtype=np.float64), (self.joints,)).copy()
        if not (np.isfinite(most).all() and (most > 0.0).all()):
            raise _refused("action_max", limits, "stated, above 0 and finite: the study has no limit of torque")
        bound = np.array(self.worlds.error_bound)
        self.bound = np.where(np.isfinite(bound), bound, 1e-3)
        self.repeat, self.failure, self.action_cost, self.action_max = repeat, failure, action_cost, most
        self.reward = reward or self._reward
        self.randomise = {ALIASES.get(key, key): _range(key, ends) for key, ends in (randomise or {}).items()}
        high = np.full(6 * self.joints, np.inf)
        self._dtype: Any = np.dtype(dtype)
        self.observation_space = self._box(high)
        self.action_space = self._box(most)

    def _box(self, most: _Array) -> gymnasium.spaces.Box:
        ends: Any = most.astype(self._dtype)
        return gymnasium.spaces.Box(-ends, ends, dtype=self._dtype)

    def begin(self, world: int, rng: np.random.Generator, options: Mapping[str, Any] | None) -> dict[str, Any]:
        """Begins an episode; what is told of it."""
        options = options or {}
        seed = int(rng.integers(2**53))
        values = {key: float(rng.uniform(*ends)) for key, ends in self.randomise.items()}
        seed = int(options.get("seed", seed))
        stated = options.get("values", {})
        values |= {ALIASES.get(key, key): float(value) for key, value in stated.items()}
        if not 0 <= seed < 2**53:
            raise _refused("options['seed']", seed, "an integer from 0 to 2^53 - 1")
        self.worlds.begin(world, seed, list(values.items()))
        told: dict[str, Any] = {"seed": seed, "t": 0.0}
        return {**told, "values": values} if values else told

    def observed(self) -> _Seen:
        """What every world senses and wants."""
        seen: _Seen = self.worlds.observed().astype(self._dtype, copy=False)
        return seen

    def step(self, acting: NDArray[np.bool_], actions: _Seen) -> tuple[_Seen, _Array, NDArray[np.bool_], NDArray[np.bool_], _Array]:
        """Acts in some worlds: observations, rewards, terminated, truncated, times."""
        actions = np.ascontiguousarray(actions, dtype=np.float64)
        if actions.shape != (len(acting), self.joints):
            raise _refused("action", actions.shape, f"of shape {(len(acting), self.joints)}")
        self.worlds.step(acting.tolist(), actions, self.repeat)
        seen = self.worlds.observed()
        times, states = self.worlds.states()
        truncated = acting & (states == _AT_ITS_END)
        terminated = acting & (states != _RUNS) & ~truncated
        # What has diverged may be no number any more.
        seen[terminated] = np.nan_to_num(seen[terminated])
        rewards = np.asarray(self.reward(seen, actions), dtype=np.float64)
        return seen.astype(self._dtype, copy=False), np.where(terminated, self.failure, np.where(acting, rewards, 0.0)), terminated, truncated, times

    def _reward(self, seen: _Array, actions: _Array) -> _Array:
        n = self.joints
        error = (seen[:, :n] - seen[:, 3 * n : 4 * n]) / self.bound
        with np.errstate(invalid="ignore"):
            cost: _Array = (error**2).mean(axis=1) + self.action_cost * ((actions / self.action_max) ** 2).mean(axis=1)
        return -cost


class Env(gymnasium.Env[_Seen, _Seen]):
    """A study's world as one environment; the module says what is observed, done and rewarded.

    Args:
        study: a study: a path, or a document.
        action: ``"torque"``, or ``"correction"`` of the torque of phihat's own law.
        gains: of that law; those that the study states or leaves to the design unless given. With ``"torque"`` they fill in what the
            study leaves to a design (its velocity filter).
        action_max: bounds of the action [N m]; the study's limits of torque unless given.
        repeat: control samples that an action holds.
        randomise: numbers of the study that every episode draws evenly anew: ``{"payload_kg": (0.0, 1.0)}``.
        reward: another reward, of arrays of one row.
        action_cost, failure, dtype, record: see the module.
        name: the study's name where it is a document.

    Raises:
        ArgumentError, StudyError, Error: an argument or the study cannot be used.
    """

    metadata: dict[str, Any] = {"render_modes": []}

    def __init__(self, study: Study, **told: Any) -> None:
        self._core = _Core(study, 1, **told)
        self.observation_space = self._core.observation_space
        self.action_space = self._core.action_space
        self._over = True

    @property
    def joint_names(self) -> list[str]:
        """Joints, in the order of all arrays."""
        return self._core.worlds.joint_names

    @property
    def dt(self) -> float:
        """Time between steps [s]."""
        return self._core.worlds.period * self._core.repeat

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[_Seen, dict[str, Any]]:
        """Begin an episode; see the module for ``options``."""
        super().reset(seed=seed)
        info = self._core.begin(0, self.np_random, options)
        self._over = False
        return self._core.observed()[0], info

    def step(self, action: _Seen) -> tuple[_Seen, float, bool, bool, dict[str, Any]]:
        """Act for ``repeat`` samples.

        Raises:
            ArgumentError: not one finite number per joint, or the episode is over.
        """
        if self._over:
            raise _refused("step", "the episode is over", "after a reset")
        actions = np.asarray(action, dtype=np.float64)[np.newaxis]
        seen, rewards, terminated, truncated, times = self._core.step(np.array([True]), actions)
        self._over = bool(terminated[0] or truncated[0])
        return seen[0], float(rewards[0]), bool(terminated[0]), bool(truncated[0]), {"t": float(times[0])}

    def trace(self) -> Trace:
        """The record of an episode that is over, every signal at every sample; it can be taken once."""
        return Trace(self._core.worlds.trace(0))


class VectorEnv(gymnasium.vector.VectorEnv[_Seen, _Seen, NDArray[Any]]):
    """Many worlds of one study side by side; each is what an :class:`Env` with its seed is, to the last bit.

    All step at once, outside of the interpreter, and on several threads where there are enough of them.

    Args:
        study: a study: a path, or a document.
        num_envs: how many.
        autoreset_mode: when an episode that is over begins anew, as Gymnasium defines it.
        told: the arguments of :class:`Env`.
    """

    metadata: dict[str, Any] = {"render_modes": []}

    def __init__(
        self,
        study: Study,
        num_envs: int,
        *,
        autoreset_mode: str | AutoresetMode = AutoresetMode.NEXT_STEP,
        **told: Any,
    ) -> None:
        if isinstance(num_envs, bool) or not isinstance(num_envs, int) or num_envs < 1:
            raise _refused("num_envs", num_envs, "an integer from 1")
        try:
            self._mode = AutoresetMode(autoreset_mode)
        except ValueError:
            limit = ", ".join(mode.value for mode in AutoresetMode)
            raise _refused("autoreset_mode", autoreset_mode, limit) from None
        self._core = _Core(study, num_envs, **told)
        self.num_envs = num_envs
        self.metadata = {**self.metadata, "autoreset_mode": self._mode}
        self.single_observation_space = self._core.observation_space
        self.single_action_space = self._core.action_space
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self.action_space = batch_space(self.single_action_space, num_envs)
        self._rngs: list[np.random.Generator | None] = [None] * num_envs
        self._over = np.ones(num_envs, dtype=np.bool_)

    @property
    def joint_names(self) -> list[str]:
        """Joints, in the order of all arrays."""
        return self._core.worlds.joint_names

    @property
    def dt(self) -> float:
        """Time between steps [s]."""
        return self._core.worlds.period * self._core.repeat

    def reset(
        self, *, seed: int | list[int | None] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[_Seen, dict[str, Any]]:
        """Begin all episodes anew, or those of ``options["reset_mask"]``; a seed ``s`` gives them ``s, s + 1, …``."""
        seeds: list[int | None]
        if seed is None:
            seeds = [None] * self.num_envs
        elif isinstance(seed, (int, np.integer)):
            seeds = [int(seed) + i for i in range(self.num_envs)]
        else:
            seeds = list(seed)
        if len(seeds) != self.num_envs:
            raise _refused("seed", seed, f"one integer, or {self.num_envs} of them")
        told = dict(options or {})
        mask = told.pop("reset_mask", np.ones(self.num_envs, dtype=np.bool_))
        fits = isinstance(mask, np.ndarray) and mask.shape == (self.num_envs,) and mask.dtype == np.bool_
        if not fits or not mask.any():
            limit = f"a NumPy array of {self.num_envs} bools, at least one of them True"
            raise _refused("options['reset_mask']", mask, limit)
        infos: dict[str, Any] = {}
        for i in np.flatnonzero(mask):
            infos = self._begin(int(i), seeds[i], told, infos)
        return self._core.observed(), infos

    def step(self, actions: _Seen) -> tuple[_Seen, NDArray[Any], NDArray[Any], NDArray[Any], dict[str, Any]]:
        """Act in all worlds for ``repeat`` samples; those that are over begin anew as ``autoreset_mode`` says.

        Raises:
            ArgumentError: not one finite number per environment and joint, or an episode is over that nobody began anew.
        """
        again = self._over.copy()
        if (unbegun := [i for i in np.flatnonzero(again) if self._rngs[i] is None]) or (
            again.any() and self._mode != AutoresetMode.NEXT_STEP
        ):
            which = unbegun or np.flatnonzero(again).tolist()
            raise _refused("step", f"episodes {which} are over", "after a reset")
        infos: dict[str, Any] = {}
        acting = ~again
        seen, rewards, terminated, truncated, times = self._core.step(acting, np.asarray(actions))
        if acting.any():
            infos = {"t": np.where(acting, times, 0.0), "_t": acting.copy()}
        self._over = terminated | truncated
        if again.any():
            for i in np.flatnonzero(again):
                infos = self._begin(int(i), None, {}, infos)
            seen[again] = self._core.observed()[again]
        if self._mode == AutoresetMode.SAME_STEP and self._over.any():
            over = np.flatnonzero(self._over)
            for i in over:
                last = {"final_obs": seen[i].copy(), "final_info": {"t": float(times[i])}}
                infos = self._begin(int(i), None, {}, self._add_info(infos, last, int(i)))
            seen[over] = self._core.observed()[over]
        return seen, rewards, terminated, truncated, infos

    def trace(self, env: int) -> Trace:
        """The record of an episode that is over and was not begun anew; it can be taken once."""
        return Trace(self._core.worlds.trace(env))

    def _begin(self, i: int, seed: int | None, options: dict[str, Any], infos: dict[str, Any]) -> dict[str, Any]:
        rng = self._rngs[i]
        if seed is not None or rng is None:
            rng, _ = seeding.np_random(seed)
            self._rngs[i] = rng
        told = self._core.begin(i, rng, options)
        self._over[i] = False
        return self._add_info(infos, told, i)


def _range(key: str, ends: Any) -> tuple[float, float]:
    try:
        low, high = (float(end) for end in ends)
    except (TypeError, ValueError):
        raise _refused(f"randomise[{key!r}]", ends, "(least, largest)") from None
    if not (np.isfinite([low, high]).all() and low <= high):
        raise _refused(f"randomise[{key!r}]", ends, "(least, largest), finite")
    return low, high


def _refused(field: str, value: Any, limit: str) -> ArgumentError:
    return ArgumentError(f"{field}: {value!r}; it must be {limit}", field=field, value=value, limit=limit)
