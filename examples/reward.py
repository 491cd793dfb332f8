"""A traffic light that is rewarded for few near misses and short queues, as a Gymnasium environment.

    pip install "closecall[sumo]" gymnasium
    python examples/reward.py sumo_nets/signals/signals.sumocfg

Plays one episode with random actions and prints what they cost. Put a learner in their place.
"""

from __future__ import annotations

import argparse
from typing import Any

import closecall
import gymnasium
import libsumo
import numpy as np
from numpy.typing import NDArray

# How long an action holds, in s; a phase with green is not left earlier.
ACTION = 5.0
# What a vehicle that waits for a second costs, where a crash costs 1.
WAITING = 1e-4


class TrafficLight(gymnasium.Env[NDArray[np.float32], np.int64]):
    """The first traffic light of a scenario: action 1 goes on to its next phase, action 0 stays in the present one."""

    def __init__(self, scenario: str, end: float = 300.0) -> None:
        self.command = ["sumo", "-c", scenario, "--no-warnings", "--no-step-log"]
        self.end = end
        self._start(seed=42)
        self.observation_space = gymnasium.spaces.Box(0.0, np.inf, (1 + len(self.lanes),), np.float32)
        self.action_space = gymnasium.spaces.Discrete(2)

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[Any, dict[str, Any]]:
        super().reset(seed=seed)
        self.close()
        self._start(seed=int(self.np_random.integers(2**31)))
        return self._observe(), {}

    def step(self, action: np.int64) -> tuple[Any, float, bool, bool, dict[str, Any]]:
        if action == 1:
            phases = len(libsumo.trafficlight.getAllProgramLogics(self.light)[0].phases)
            libsumo.trafficlight.setPhase(self.light, (libsumo.trafficlight.getPhase(self.light) + 1) % phases)
        crashes = waiting = 0.0
        until = libsumo.simulation.getTime() + ACTION
        while libsumo.simulation.getTime() < until:
            libsumo.simulationStep()
            seconds = libsumo.simulation.getDeltaT()
            crashes += self.reward.total() * seconds
            waiting += sum(map(libsumo.lane.getLastStepHaltingNumber, self.lanes)) * seconds
        is_over = libsumo.simulation.getTime() >= self.end
        costs = {"crashes": crashes, "waiting": waiting}
        return self._observe(), -(crashes + WAITING * waiting), False, is_over, costs

    def close(self) -> None:
        self.checker.close()
        libsumo.close()

    def _start(self, seed: int) -> None:
        libsumo.start([*self.command, "--seed", str(seed)])
        self.checker = closecall.Checker(libsumo, paint=False, keep=0)
        libsumo.addStepListener(self.checker)
        self.reward = closecall.Reward(self.checker)
        self.light = libsumo.trafficlight.getIDList()[0]
        self.lanes = sorted(set(libsumo.trafficlight.getControlledLanes(self.light)))

    def _observe(self) -> NDArray[np.float32]:
        queues = map(libsumo.lane.getLastStepHaltingNumber, self.lanes)
        return np.array([libsumo.trafficlight.getPhase(self.light), *queues], np.float32)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenario")
    parser.add_argument("--end", type=float, default=300.0, help="simulated seconds of the episode")
    arguments = parser.parse_args()
    env = TrafficLight(arguments.scenario, arguments.end)
    env.reset(seed=1)
    env.action_space.seed(1)
    total, steps, is_over = 0.0, 0, False
    while not is_over:
        _, reward, _, is_over, _ = env.step(env.action_space.sample())
        total, steps = total + reward, steps + 1
    env.close()
    print(f"{steps} actions, reward {total:.3f}")


if __name__ == "__main__":
    main()
