"""Near misses in the reward of any Gymnasium environment of SUMO, here of sumo-rl.

    pip install "closecall[sumo]" eclipse-sumo gymnasium sumo-rl
    python examples/near_misses.py sumo_nets/signals

Plays one episode of sumo-rl with random actions and prints what near misses cost. Put a learner in their place.
"""

from __future__ import annotations

import argparse
import os
from pathlib import Path
from typing import Any

import closecall
import gymnasium


class Costs(closecall.Checker):
    """A checker that adds up the cost of each step, also of those between two actions."""

    cost = 0.0

    def step(self, *arguments: Any) -> bool:
        before, goes_on = self.time, super().step(*arguments)
        if before is not None and self.time is not None:
            self.cost += closecall.Reward(self).total() * (self.time - before)
        return goes_on


class NearMisses(gymnasium.Wrapper[Any, Any, Any, Any]):
    """Subtracts the cost of near misses from the reward; `info` has that cost and the alarms of the action.

    Args:
        env: an environment whose attribute `sumo` is libsumo or its connection of traci from `reset` on, as in sumo-rl.
        weight: what a collision costs for each second that it lasts, in units of the environment's own reward.
        options: those of `closecall.Checker`.
    """

    def __init__(self, env: gymnasium.Env[Any, Any], weight: float = 1.0, **options: Any) -> None:
        super().__init__(env)
        self.weight, self.options = weight, options
        self.checker: Costs | None = None
        self.alarms: list[closecall.Alarm] = []

    def reset(self, **arguments: Any) -> tuple[Any, dict[str, Any]]:
        self._detach()
        observation, info = self.env.reset(**arguments)
        sumo = self.env.unwrapped.sumo  # type: ignore[attr-defined]
        self.checker = Costs(sumo, paint=False, keep=0, on_alarm=self.alarms.append, **self.options)
        sumo.addStepListener(self.checker)
        return observation, info

    def step(self, action: Any) -> tuple[Any, Any, bool, bool, dict[str, Any]]:
        assert self.checker is not None, "reset before the first step"
        self.alarms.clear()
        self.checker.cost = 0.0
        observation, reward, terminated, truncated, info = self.env.step(action)
        near = {"near_misses": self.checker.cost, "alarms": list(self.alarms)}
        return observation, reward - self.weight * self.checker.cost, terminated, truncated, {**info, **near}

    def close(self) -> None:
        self._detach()
        self.env.close()

    def _detach(self) -> None:
        if self.checker is not None:
            self.checker.close()
            self.checker = None


def sumo_rl(net: str, routes: str, seconds: int) -> gymnasium.Env[Any, Any]:
    """The first traffic light of a net, as sumo-rl's environment for a single agent."""
    import sumo

    # sumo-rl does not start without it. LIBSUMO_AS_TRACI=1 makes it use libsumo, which is several times faster.
    os.environ.setdefault("SUMO_HOME", sumo.SUMO_HOME)
    from sumo_rl import SumoEnvironment

    environment: gymnasium.Env[Any, Any] = SumoEnvironment(
        net_file=net,
        route_file=routes,
        num_seconds=seconds,
        single_agent=True,
        sumo_warnings=False,
        additional_sumo_cmd="--no-step-log --step-length 0.5",
    )
    return environment


def episode(env: NearMisses) -> tuple[float, float, int]:
    """An episode of random actions: the sum of its rewards, that of the cost of near misses, the number of alarms."""
    env.reset(seed=1)
    env.action_space.seed(1)
    total, cost, alarms, is_over = 0.0, 0.0, 0, False
    while not is_over:
        _, reward, _, is_over, info = env.step(env.action_space.sample())
        total, cost, alarms = total + reward, cost + info["near_misses"], alarms + len(info["alarms"])
    return total, cost, alarms


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path, help="a folder with a net and routes named after it")
    parser.add_argument("--end", type=int, default=300, help="simulated seconds of the episode")
    arguments = parser.parse_args()
    net, routes = (str(arguments.folder / f"{arguments.folder.name}.{kind}.xml") for kind in ("net", "rou"))
    env = NearMisses(sumo_rl(net, routes, arguments.end), weight=100.0)
    total, cost, alarms = episode(env)
    env.close()
    print(f"reward {total:.2f}; near misses cost {cost:.3f}, {alarms} alarms")


if __name__ == "__main__":
    main()
