//! How simulations are distinguished: `load` and `loadState` replace one silently.
//!
//! Compared are the time, the numbers of vehicles that were ever loaded and inserted, and where the time makes a jump the
//! configuration, the net and the seed. Two states of the same scenario and seed at the same time are the same simulation.
//!
//! If a script calls `executeMove` after a step, SUMO already does most of the next one. The lists of that step are then empty:
//! vehicles are inserted that, by the lists, did not depart.

use closecall::util::units::Second;
use closecall_run::util::decimal::Written;
use pyo3::prelude::*;

use super::option;

/// The options that are another simulation's where they differ.
const OPTIONS: [&str; 3] = ["configuration-file", "net-file", "seed"];
/// SUMO's times are whole milliseconds.
const SAME_TIME: Second = 5e-4;

/// A simulation as it was in the last step.
pub struct Identity {
    source: Py<PyAny>,
    step_length: Second,
    options: [String; 3],
    /// The vehicles ever loaded and inserted; none where SUMO does not tell.
    counts: Option<[u64; 2]>,
    /// Whether a script has called `executeMove`.
    has_moves_between: bool,
}

impl Identity {
    pub fn of(source: &Bound<PyAny>) -> PyResult<Self> {
        Ok(Self {
            step_length: source.getattr("simulation")?.call_method0("getDeltaT")?.extract()?,
            options: options(source)?,
            counts: counts(source),
            has_moves_between: false,
            source: source.clone().unbind(),
        })
    }

    /// Whether SUMO's lists of a step do not name all that happened since the last one, as a script has called `executeMove`.
    pub fn has_moves_between(&self) -> bool {
        self.has_moves_between
    }

    /// Why the simulation, now at `time`, is another than the one whose last step was at `last`; none if it is the same.
    /// `asked` is the argument of the only `simulationStep` since then, if that is known: 0 for one step, or the time to
    /// step to.
    pub fn is_another(
        &mut self,
        py: Python,
        last: Option<Second>,
        time: Second,
        asked: Option<Second>,
    ) -> PyResult<Option<String>> {
        let source = self.source.bind(py);
        let now = counts(source);
        let before = std::mem::replace(&mut self.counts, now);
        let Some(last) = last else {
            return self.has_other_options(source);
        };
        if time < last {
            return Ok(Some(format!("the simulation's time went back from {} to {} s", Written(last), Written(time))));
        }
        if let (Some([loaded, inserted]), Some([now_loaded, now_inserted])) = (before, now)
            && (now_loaded < loaded || now_inserted < inserted)
        {
            return Ok(Some(format!("the simulation has loaded {now_loaded} vehicles, after {loaded} before")));
        }
        if time == last {
            return self.has_other_options(source);
        }
        let step = self.step_length;
        let is_next = (time - last - step).abs() < SAME_TIME;
        let is_due = match asked {
            None => true,
            Some(until) if until > 0.0 => (time - (until - step)).abs() < step,
            Some(_) => is_next,
        };
        if !is_due {
            return Ok(Some(format!(
                "the simulation's time went from {} to {} s in one call of simulationStep",
                Written(last),
                Written(time)
            )));
        }
        if !is_next {
            return self.has_other_options(source);
        }
        let (Some([_, inserted]), Some([_, now_inserted])) = (before, now) else { return Ok(None) };
        let departed: u64 = source.getattr("simulation")?.call_method0("getDepartedNumber")?.extract()?;
        if now_inserted == inserted + departed {
            return Ok(None);
        }
        // Those of another state departed at other times.
        if now_inserted > inserted + departed && departed_at(source, time)? >= now_inserted - inserted {
            self.has_moves_between = true;
            return Ok(None);
        }
        Ok(Some(format!(
            "the simulation has inserted {now_inserted} vehicles, after {inserted} before and {departed} since"
        )))
    }

    fn has_other_options(&self, source: &Bound<PyAny>) -> PyResult<Option<String>> {
        let is_same = options(source)? == self.options;
        Ok((!is_same).then(|| "the simulation has another configuration, net or seed".to_owned()))
    }
}

/// The number of vehicles in the simulation that departed at this time.
fn departed_at(source: &Bound<PyAny>, time: Second) -> PyResult<u64> {
    let vehicles = source.getattr("vehicle")?;
    let mut count = 0;
    for id in vehicles.call_method0("getIDList")?.try_iter()? {
        let departure = vehicles.call_method1("getDeparture", (id?,))?.extract::<Second>()?;
        count += u64::from((departure - time).abs() < SAME_TIME);
    }
    Ok(count)
}

fn options(source: &Bound<PyAny>) -> PyResult<[String; 3]> {
    let [configuration, net, seed] = OPTIONS.map(|name| option(source, name));
    Ok([configuration?, net?, seed?])
}

fn counts(source: &Bound<PyAny>) -> Option<[u64; 2]> {
    let simulation = source.getattr("simulation").ok()?;
    let count = |key: &str| {
        let text = simulation.call_method1("getParameter", ("", key)).ok()?.extract::<String>().ok()?;
        text.parse::<u64>().ok()
    };
    Some([count("stats.vehicles.loaded")?, count("stats.vehicles.inserted")?])
}
