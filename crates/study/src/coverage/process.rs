//! Conflicts that come one by one, or in clusters.

use crate::reference::chance::Chance;

/// The mean size of a cluster.
const CLUSTER: f64 = 3.0;

/// How conflicts come.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Process {
    Single,
    Clusters,
}

impl Process {
    pub(super) const ALL: [Self; 2] = [Self::Single, Self::Clusters];

    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Single => "Poisson",
            Self::Clusters => "clusters",
        }
    }

    /// The number of conflicts of a run with this many on average.
    pub(super) fn count(self, mean: f64, chance: &mut Chance) -> f64 {
        match self {
            Self::Single => poisson(mean, chance),
            Self::Clusters => {
                let clusters = poisson(mean / CLUSTER, chance) as usize;
                // Sizes from 1 on, of which each goes on with the probability 1 − 1/3.
                let size = |chance: &mut Chance| 1.0 + (uniform(chance).ln() / (1.0 - 1.0 / CLUSTER).ln()).floor();
                (0..clusters).map(|_| size(chance)).sum()
            }
        }
    }

    pub(super) fn counts(self, runs: usize, mean: f64, chance: &mut Chance) -> Vec<f64> {
        (0..runs).map(|_| self.count(mean, chance)).collect()
    }
}

/// A number above 0, up to 1.
pub(super) fn uniform(chance: &mut Chance) -> f64 {
    1.0 - chance.between(0.0, 1.0)
}

/// A count of independent events: how many exponential times fit into `mean`.
fn poisson(mean: f64, chance: &mut Chance) -> f64 {
    let (mut count, mut time) = (0.0, -uniform(chance).ln());
    while time < mean {
        count += 1.0;
        time -= uniform(chance).ln();
    }
    count
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn clusters_have_five_times_the_variance_of_single_conflicts() {
        for (process, wanted) in [(Process::Single, 1.0), (Process::Clusters, 5.0)] {
            let counts = process.counts(20_000, 30.0, &mut Chance::new(1));
            let mean = counts.iter().sum::<f64>() / 20_000.0;
            let variance = counts.iter().map(|count| (count - mean).powi(2)).sum::<f64>() / 20_000.0;
            assert!((mean - 30.0).abs() < 0.4 && (variance / mean / wanted - 1.0).abs() < 0.05, "{mean} {variance}");
        }
    }
}
