"""How well a score tells crashes from crash-free pairs: AUC with DeLong's interval, AUPRC with a bootstrap's."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.stats import beta, rankdata

# Two-sided, 95 %.
NORMAL_QUANTILE = 1.959964
RESAMPLES = 2000
SEED = 1


@dataclass(frozen=True)
class Estimate:
    """A value and its 95 % interval."""

    value: float
    low: float
    high: float


def auc(crashes: np.ndarray, free: np.ndarray) -> Estimate:
    """The probability that a crash scores higher than a crash-free pair; ties count half (DeLong et al. 1988).

    Where no pair is in the wrong order, DeLong's variance is 0. The interval's lower end is then that of the rarer
    class: the one-sided 97.5 % bound for no failure among so many (Clopper and Pearson 1934).
    """
    few, many = len(crashes), len(free)
    ranks = rankdata(np.concatenate([crashes, free]))
    of_crashes = (ranks[:few] - rankdata(crashes)) / many
    of_free = 1 - (ranks[few:] - rankdata(free)) / few
    value = float(of_crashes.mean())
    if value == 1.0:
        return Estimate(1.0, float(beta.ppf(0.025, min(few, many), 1)), 1.0)
    variance = of_crashes.var(ddof=1) / few + of_free.var(ddof=1) / many
    half = NORMAL_QUANTILE * float(np.sqrt(variance))
    return Estimate(value, max(value - half, 0.0), min(value + half, 1.0))


def average_precision(crashes: np.ndarray, free: np.ndarray) -> float:
    """The area under precision over recall in steps; those of equal score are taken together."""
    scores = np.concatenate([crashes, free])
    is_crash = np.concatenate([np.ones(len(crashes)), np.zeros(len(free))])
    order = np.argsort(-scores, kind="stable")
    scores, is_crash = scores[order], is_crash[order]
    last_of_its_score = np.append(np.flatnonzero(scores[1:] != scores[:-1]), len(scores) - 1)
    found = np.cumsum(is_crash)[last_of_its_score]
    precision = found / (last_of_its_score + 1)
    return float((np.diff(found, prepend=0) / len(crashes) * precision).sum())


def auprc(crashes: np.ndarray, free: np.ndarray) -> Estimate:
    """Average precision; the percentiles of resamples of crashes and of crash-free pairs, each drawn among its own."""
    chance = np.random.default_rng(SEED)
    drawn = [
        average_precision(chance.choice(crashes, len(crashes)), chance.choice(free, len(free)))
        for _ in range(RESAMPLES)
    ]
    low, high = np.percentile(drawn, [2.5, 97.5])
    return Estimate(average_precision(crashes, free), float(low), float(high))


def share(found: int, of: int) -> Estimate:
    """A share with Clopper and Pearson's interval."""
    low = float(beta.ppf(0.025, found, of - found + 1)) if found else 0.0
    high = float(beta.ppf(0.975, found + 1, of - found)) if found < of else 1.0
    return Estimate(found / of, low, high)
