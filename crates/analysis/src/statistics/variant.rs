//! Statistics of each variant: runs that agree in all settings, with rates of their own.

use std::cmp::Reverse;
use std::collections::BTreeSet;

use rustc_hash::FxHashMap;
use serde::Serialize;

use super::collect::Collection;
use super::counts::{ConflictGroup, MEASURES};
use super::group::By;
use super::pairs::{Unit, pairs, ratio};
use super::quantiles::Quantiles;
use super::rate::Ratio;
use super::rates::{Rates, Traffic};
use super::together::together;
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
        let mut groups = names.iter().map(|name| groups.remove(name).unwrap_or_default()).collect::<Vec<_>>();
        let mut quantiles = quantiles(&mut groups).into_iter();
        for (name, group) in names.iter().zip(groups) {
            let of_group = quantiles.next().unwrap_or_default();
            add(name, group.counts.of(&variant.runs), group.collisions, of_group);
        }
        let of_all = quantiles.next().unwrap_or_default();
        add("all", variant.runs.iter().map(|run| all[*run]).collect(), collisions, of_all);
        of_variant.rotate_right(1);
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

/// The quantiles of each measure over each of the groups, and then over all of them. Takes the groups' values; each measure
/// has a thread of its own.
fn quantiles(groups: &mut [ConflictGroup]) -> Vec<Vec<Quantiles>> {
    let mut of_measure =
        |measure: usize| groups.iter_mut().map(|group| std::mem::take(&mut group.columns[measure])).collect::<Vec<_>>();
    let columns: [_; MEASURES.len()] = std::array::from_fn(&mut of_measure);
    let by_measure = together(columns.map(|mut of_groups| {
        move || {
            let mut found = of_groups.iter_mut().map(|values| Quantiles::of(values)).collect::<Vec<_>>();
            // In the memory of the largest: all values again would be much for a large set.
            let count = of_groups.iter().map(Vec::len).sum::<usize>();
            of_groups.sort_unstable_by_key(|values| Reverse(values.len()));
            let mut of_groups = of_groups.drain(..);
            let mut all = of_groups.next().unwrap_or_default();
            all.reserve_exact(count - all.len());
            of_groups.for_each(|values| all.extend_from_slice(&values));
            found.push(Quantiles::of(&mut all));
            found
        }
    }));
    (0..=groups.len()).map(|group| by_measure.iter().map(|of_groups| of_groups[group]).collect()).collect()
}
