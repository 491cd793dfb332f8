//! Statistics of each variant: runs that agree in all settings, with rates of their own.

use std::collections::BTreeSet;

use rustc_hash::FxHashMap;
use serde::Serialize;

use super::collect::Collection;
use super::counts::{Columns, ConflictGroup, MEASURES};
use super::group::By;
use super::pairs::{Unit, pairs, ratio};
use super::quantiles::Quantiles;
use super::rate::Ratio;
use super::rates::{Rates, Traffic};
use crate::variants::Variant;

/// A variant and its traffic.
#[derive(Clone, Debug, Serialize)]
pub struct VariantStatistics {
    /// What tells it from the others.
    #[serde(flatten)]
    pub variant: Variant,
    /// The number of runs.
    pub runs: usize,
    /// Their traffic.
    pub traffic: Traffic,
}

/// The rate of a variant, divided by that of the first.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct VariantRatio {
    /// The unit of traffic.
    pub rates_per: &'static str,
    /// The ratio and its interval; its method tells whether the runs are in pairs.
    #[serde(flatten)]
    pub ratio: Ratio,
}

/// Statistics of a group of conflicts.
#[derive(Clone, Debug, Serialize)]
pub struct GroupStatistics {
    /// The name of the variant; none if there is only one.
    pub variant: Option<String>,
    /// The name of the group; `all` for all conflicts.
    pub group: String,
    /// The number of conflicts.
    pub count: u64,
    /// The number of conflicts in which the rectangles overlapped.
    pub collisions: u64,
    /// The rates.
    #[serde(flatten)]
    pub rates: Rates,
    /// The rate divided by that of the first variant; none for the first.
    pub ratio: Option<VariantRatio>,
    /// Time to collision, in s.
    pub ttc: Quantiles,
    /// Post-encroachment time, in s.
    pub pet: Quantiles,
    /// gap − μ, in m.
    pub margin: Quantiles,
    /// Speed change in a collision, in m/s.
    pub delta_v: Quantiles,
}

/// The variants and their traffic.
pub(super) fn statistics(set: &Collection) -> Vec<VariantStatistics> {
    let of = |variant: &Variant| VariantStatistics {
        variant: variant.clone(),
        runs: variant.runs.len(),
        traffic: Traffic::of(set.members(variant).into_iter()),
    };
    set.variants.all.iter().map(of).collect()
}

/// The statistics of all groups: for each variant all its conflicts, then each of its groups. A group that only another
/// variant has is a rate of 0.
pub(super) fn groups(set: &mut Collection, by: By) -> Vec<GroupStatistics> {
    let mut of_variants = std::mem::take(&mut set.groups);
    let names = of_variants.iter().flat_map(FxHashMap::keys).cloned().collect::<BTreeSet<_>>();
    let all = set.counts(None, None);
    let mut first = FxHashMap::default();
    let mut found = Vec::new();
    for (variant, groups) in set.variants.all.iter().zip(&mut of_variants) {
        let runs = set.members(variant);
        let mut of_variant = Vec::with_capacity(names.len() + 1);
        let mut add = |name: &str, counts: Vec<f64>, collisions: u64, quantiles: Vec<Quantiles>| {
            of_variant.push((name.to_owned(), counts, collisions, quantiles));
        };
        let collisions = groups.values().map(|group| group.collisions).sum();
        let columns = (0..MEASURES.len()).map(|measure| of_all(groups, measure)).collect();
        add("all", variant.runs.iter().map(|run| all[*run]).collect(), collisions, columns);
        for name in &names {
            let mut group = groups.remove(name).unwrap_or_default();
            add(name, group.counts.of(&variant.runs), group.collisions, quantiles(&mut group.columns));
        }
        if found.is_empty() {
            first = of_variant.iter().map(|(name, counts, ..)| (name.clone(), counts.clone())).collect();
        }
        let other = set.members(&set.variants.all[0]);
        let unit = Unit::of(&[&runs, &other]);
        let paired = pairs(&runs, &other);
        let is_first = found.is_empty();
        let of_group = |(group, counts, collisions, quantiles): (String, Vec<f64>, u64, Vec<Quantiles>)| {
            let against = first.get(&group).filter(|_| !is_first).and_then(|first| {
                let traffic = [unit.of_each(&runs), unit.of_each(&other)];
                ratio((&counts, &traffic[0]), (first, &traffic[1]), paired.as_deref())
            });
            let of = |name: &str| {
                MEASURES.iter().position(|measure| *measure == name).map_or_else(Default::default, |at| quantiles[at])
            };
            GroupStatistics {
                variant: set.variants.are_several().then(|| variant.name.clone()),
                group,
                count: counts.iter().sum::<f64>() as u64,
                collisions,
                rates: Rates::of(&counts, &runs),
                ratio: against.map(|ratio| VariantRatio { rates_per: unit.name, ratio }),
                ttc: of("ttc"),
                pet: of("pet"),
                margin: of("margin"),
                delta_v: of("delta_v"),
            }
        };
        let mut of_variant = of_variant.into_iter().map(of_group).collect::<Vec<_>>();
        by.sort(&mut of_variant[1..], |group| &group.group, |group| group.count);
        found.extend(of_variant);
    }
    found
}

/// Quantiles of a measure over all groups of a variant.
fn of_all(groups: &FxHashMap<String, ConflictGroup>, measure: usize) -> Quantiles {
    let mut values = Vec::with_capacity(groups.values().map(|group| group.columns[measure].len()).sum());
    groups.values().for_each(|group| values.extend_from_slice(&group.columns[measure]));
    Quantiles::of(&mut values)
}

fn quantiles(columns: &mut Columns) -> Vec<Quantiles> {
    columns.iter_mut().map(|values| Quantiles::of(values)).collect()
}
