//! The table of measures: a row for each that an event reduces to one value over its steps.
//!
//! A new measure is its formula, in a file beside this one, and a row of [`chosen_measures`](crate::chosen_measures). The
//! option `measures`, the values of steps and events, the log's column, Parquet, Python and the tables of the docs follow
//! from the row.

use crate::util::units::{MetrePerSecond, MetrePerSecondSquared, Probability, Second};

/// What an event keeps of the values of its steps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Over {
    /// The smallest.
    Least,
    /// The largest.
    Most,
    /// That of the step with the smallest margin.
    Worst,
    /// That of the step with the smallest TTC.
    LeastTtc,
    /// That of the step in which braking begins: the first with a conflicting speed.
    Onset,
    /// The first below 0, or else the smallest.
    FirstBelowZero,
    /// Their integral over time.
    Integral,
    /// Their mean over time.
    Mean,
}

/// Makes [`LoggedMeasure`] and [`LoggedValues`] of the rows below: meaning; variant and name; unit; rule over the steps; what
/// an event has where no step has a value.
macro_rules! logged_measures {
    ($( $(#[doc = $meaning:literal])+ $variant:ident $name:ident: $unit:ty, $over:ident, $without:expr; )+) => {
        /// A measure of each pair that is measured, in every log.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum LoggedMeasure {
            $( $(#[doc = $meaning])+ $variant, )+
        }

        /// A value of each [`LoggedMeasure`], of a step or of an event so far.
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub struct LoggedValues([Option<f64>; [$(stringify!($name)),+].len()]);

        impl LoggedValues {
            const OVER: [Over; [$(stringify!($name)),+].len()] = [$(Over::$over),+];

            /// Without a value of any.
            pub(crate) const NONE: Self = Self([$($without),+]);

            $(
                $(#[doc = $meaning])+
                pub fn $name(&self) -> Option<$unit> {
                    self.0[LoggedMeasure::$variant as usize]
                }
            )+
        }
    };
}

logged_measures! {
    /// Time to collision at the current speeds, along the paths; none if the two never touch.
    Ttc ttc: Second, Least, None;
    /// Deceleration that just avoids contact, at most 12.68 m/s²; none if the two touch now or, at the current speeds, never.
    Drac drac: MetrePerSecondSquared, Most, None;
    /// Longest response time with which the ego keeps clear of a foe that brakes now; none if the ego stands.
    ResponseLeft response_left: Second, Least, None;
    /// Time to brake: the longest wait before full braking avoids contact with a foe that goes on as now; 0 if even braking
    /// at once is too late, none if the two would not touch.
    Ttb ttb: Second, Least, None;
    /// Probability that the driver does not brake in time if the foe goes on as now.
    CrashProbability crash_probability: Probability, Most, Some(0.0);
    /// The same if the foe brakes fully now.
    CrashProbabilityBraking crash_probability_braking: Probability, Most, Some(0.0);
    /// The larger ΔV of both if each brakes until they touch; none if the two would not touch.
    ExtendedDeltaV extended_delta_v: MetrePerSecond, Most, None;
}

impl LoggedValues {
    /// With another value of a measure.
    pub(crate) fn with(mut self, measure: LoggedMeasure, value: Option<f64>) -> Self {
        self.0[measure as usize] = value;
        self
    }

    /// Takes a value where it is beyond the extreme so far; returns whether it was.
    pub(crate) fn take(&mut self, measure: LoggedMeasure, now: Option<f64>) -> bool {
        let place = measure as usize;
        let is_beyond = |now: f64, known: f64| if Self::OVER[place] == Over::Least { now < known } else { now > known };
        let is_taken = now.is_some_and(|now| self.0[place].is_none_or(|known| is_beyond(now, known)));
        if is_taken {
            self.0[place] = now;
        }
        is_taken
    }

    /// Takes each value of another step, or of other carriages, that is beyond the extreme so far; returns whether the TTC and
    /// the DRAC were.
    pub(crate) fn take_all(&mut self, now: &Self) -> [bool; 2] {
        use LoggedMeasure::{CrashProbability, CrashProbabilityBraking, Drac, ExtendedDeltaV, ResponseLeft, Ttb, Ttc};
        for measure in [ResponseLeft, Ttb, CrashProbability, CrashProbabilityBraking, ExtendedDeltaV] {
            self.take(measure, now.0[measure as usize]);
        }
        [Ttc, Drac].map(|measure| self.take(measure, now.0[measure as usize]))
    }
}

/// Hands the measures that a log has only if they are chosen to a macro, which gets what is given and then the rows: meaning;
/// variant and name; unit; rule over the steps ([`Over`](crate::detection::measures::table::Over)); value of a pair in a step.
#[macro_export]
macro_rules! chosen_measures {
    ($make:ident! $($given:tt)*) => {
        $make! { $($given)*
            /// time advantage, the predicted PET: minimum at constant speeds; 0 on a collision course; side and frontal only
            Tadv tadv: Second, Least = |pair| pair.advantage.map(|advantage| advantage.tadv);
            /// T2: minimum time until the second enters the conflict area at constant speeds; the TTC on a collision course;
            /// side and frontal only
            T2 t2: Second, Least = |pair| pair.advantage.map(|advantage| advantage.t2);
            /// safe longitudinal distance by RSS; rear-end and frontal only
            RssDistance rss_distance: Metre, Worst = |pair| pair.rss_distance();
            /// safe lateral distance by RSS; rear-end and frontal only
            RssLateralDistance rss_lateral_distance: Metre, Worst = |pair| pair.rss_lateral_distance();
            /// how long the gap was below `rss_distance`
            RssViolation rss_violation: Second, Integral =
                |pair| pair.rss_distance().map(|safe| f64::from(pair.found.gap < safe));
            /// minimum time headway from front to front; rear-end only
            Thw thw: Second, Least = |pair| pair.time_headway();
            /// space gap: minimum gap; rear-end only
            Sgap sgap: Metre, Least = |pair| pair.behind().map(|_| pair.found.gap);
            /// brake rate: the ego's maximum deceleration; empty if none
            Br br: MetrePerSecondSquared, Most = |pair| Some(-pair.ego.acceleration).filter(|braking| *braking > 0.0);
            /// modified DRAC: maximum deceleration that is enough after a reaction time of 1 s; at most 12.68 m/s²; rear-end
            /// only
            Mdrac mdrac: MetrePerSecondSquared, Most =
                |pair| mdrac::mdrac(pair.found.gap, pair.ego.moving.speed - pair.behind()?.speed);
            /// modified TTC: minimum at constant accelerations; rear-end only
            Mttc mttc: Second, Least = |pair| pair.mttc().map(|(time, _)| time);
            /// crash index: maximum; rear-end only
            CrashIndex crash_index: MetreSquaredPerSecondCubed, Most = |pair| pair.mttc()?.1;
            /// time exposed to a TTC of at most 3 s
            Tet tet: Second, Integral = |pair| Some(exposure::exposed(pair.ttc()));
            /// integral of what the TTC lacks to 3 s
            Tit tit: SecondSquared, Integral = |pair| Some(exposure::lacks(pair.ttc()));
            /// crash potential index: mean probability that the ego's brakes are weaker than the DRAC
            Cpi cpi: Probability, Mean = |pair| Some(pair.crash_potential());
            /// maximum required longitudinal deceleration; the DRAC unless rear-end; at most 12.68 m/s²
            ALongReq a_long_req: MetrePerSecondSquared, Most = |pair| pair.required_braking();
            /// maximum required lateral acceleration to be beside the foe at the TTC; at most 12.68 m/s²; rear-end and frontal
            /// only
            ALatReq a_lat_req: MetrePerSecondSquared, Most = |pair| pair.required_steering();
            /// brake threat number: `a_long_req` over the ego's braking deceleration
            Btn btn: Ratio, Most = |pair| pair.required_braking().map(|needed| needed / pair.ego.of.brakes.deceleration);
            /// steer threat number: `a_lat_req` over the ego's braking deceleration
            Stn stn: Ratio, Most = |pair| pair.required_steering().map(|needed| needed / pair.ego.of.brakes.deceleration);
            /// time to accident: the TTC when the first brakes with at least 1.3 m/s²; empty if there is none
            Ta ta: Second, Onset = |pair| pair.conflicting_speed().and(pair.time_to_accident());
            /// speed of that one before it brakes
            ConflictingSpeed conflicting_speed: MetrePerSecond, Onset = |pair| pair.conflicting_speed();
            /// severity level of the Swedish technique, 1 to 30; serious from 26 on
            TaLevel ta_level: Ratio, Onset = |pair| {
                pair.conflicting_speed().zip(pair.time_to_accident()).map(|(speed, ta)| accident::level(ta, speed))
            };
            /// SSAM's MaxS: the maximum speed of either
            MaxS max_s: MetrePerSecond, Most = |pair| Some(pair.ego.moving.speed.max(pair.foe.moving.speed));
            /// SSAM's DeltaS: size of the velocity difference at the minimum TTC
            DeltaS delta_s: MetrePerSecond, LeastTtc =
                |pair| pair.ttc().map(|_| delta_s(&pair.ego.moving, &pair.foe.moving));
            /// SSAM's DR: the ego's first acceleration below 0, or else its smallest
            Dr dr: MetrePerSecondSquared, FirstBelowZero = |pair| Some(pair.ego.acceleration);
            /// SSAM's MaxD: the ego's minimum acceleration, below 0 where it brakes
            MaxD max_d: MetrePerSecondSquared, Least = |pair| Some(pair.ego.acceleration);
            /// anticipated collision time: minimum of the distance over the speed at which it decreases
            Act act: Second, Least = |pair| pair.in_plane().and_then(|[ego, foe]| anticipated_collision_time(ego, foe));
            /// emergency index: maximum of how deep both would overlap over the time until they are nearest
            Ei ei: MetrePerSecond, Most = |pair| pair.in_plane().and_then(|[ego, foe]| emergency_index(ego, foe));
            /// largest deceleration of the vehicles of the pair before they touch, where it is at least 1.3 m/s²: braking that was
            /// really seen; empty if neither braked so hard
            MaxBraking max_braking: MetrePerSecondSquared, Most = |pair| {
                let vehicles = [&pair.ego, &pair.foe].into_iter().filter(|user| user.of.category == Category::Vehicle);
                accident::evasive_braking(vehicles.map(|user| user.acceleration)).filter(|_| !pair.found.collision)
            };
        }
    };
}
