//! The steps of a recording for the replay: a thread of its own may read them ahead, while the steps before are checked.

use std::sync::mpsc::{Receiver, sync_channel};
use std::thread;
use std::vec;

use super::recorded_step::{RecordedRow, RecordedStep};
use super::recording::Recording;
use crate::util::panics;
use crate::{Error, Result};

/// Steps are handed over together from this many rows on, or from this many steps on: waking a thread takes as long as
/// reading a hundred rows.
const ROWS: usize = 4096;
const STEPS: usize = 64;
/// This many such batches may wait.
const WAITING: usize = 2;

/// The steps of a recording.
pub(super) enum Steps {
    InPlace(Recording),
    Ahead(StepsAhead),
}

/// Steps that a thread reads, and the names behind their numbers.
pub(super) struct StepsAhead {
    batches: Receiver<Batch>,
    batch: vec::IntoIter<NamedStep>,
    /// What ended the recording, after the steps of the batch.
    end: Option<Result<()>>,
    ids: Vec<String>,
    types: Vec<String>,
    lanes: Vec<String>,
}

/// Steps that follow each other, and how the recording ends, if it ends after them.
#[derive(Default)]
struct Batch {
    steps: Vec<NamedStep>,
    end: Option<Result<()>>,
}

/// A step with the names that no step before it has.
struct NamedStep {
    step: RecordedStep,
    ids: Vec<(u32, String)>,
    types: Vec<String>,
    lanes: Vec<String>,
}

impl Steps {
    /// Reads the next step; `false` at the end of the recording.
    ///
    /// # Errors
    /// Those of [`Recording::next_step`].
    pub fn next_step(&mut self, step: &mut RecordedStep) -> Result<bool> {
        match self {
            Self::InPlace(recording) => recording.next_step(step),
            Self::Ahead(ahead) => ahead.next_step(step),
        }
    }

    /// As [`Recording::id`].
    pub fn id(&self, user: u32) -> &str {
        match self {
            Self::InPlace(recording) => recording.id(user),
            Self::Ahead(ahead) => text(&ahead.ids, user),
        }
    }

    /// As [`Recording::type_name`].
    pub fn type_name(&self, row: &RecordedRow) -> &str {
        match self {
            Self::InPlace(recording) => recording.type_name(row),
            Self::Ahead(ahead) => text(&ahead.types, row.type_name),
        }
    }

    /// As [`Recording::lane`].
    pub fn lane(&self, lane: u32) -> &str {
        match self {
            Self::InPlace(recording) => recording.lane(lane),
            Self::Ahead(ahead) => text(&ahead.lanes, lane),
        }
    }

    /// Has a thread read the steps from here on.
    ///
    /// # Errors
    /// [`Error::Value`] where the system gives no thread.
    pub fn read_ahead(self) -> Result<Self> {
        match self {
            Self::InPlace(recording) => StepsAhead::new(recording).map(Self::Ahead),
            ahead @ Self::Ahead(_) => Ok(ahead),
        }
    }
}

fn text(texts: &[String], place: u32) -> &str {
    texts.get(place as usize).map_or("", String::as_str)
}

impl StepsAhead {
    fn new(mut recording: Recording) -> Result<Self> {
        let (sender, batches) = sync_channel(WAITING);
        let [types, lanes] = [&recording.users.types, &recording.users.lanes].map(|names| names.after(0).to_vec());
        let ids = recording.users.ids().map(str::to_owned).collect();
        let mut known = [types.len(), lanes.len()];
        let read = move || {
            loop {
                let batch = next_batch(&mut recording, &mut known);
                let has_ended = batch.end.is_some();
                if sender.send(batch).is_err() || has_ended {
                    return;
                }
            }
        };
        let started = thread::Builder::new().spawn(read);
        started.map_err(|error| Error::Value(format!("no thread to read ahead: {error}")))?;
        Ok(Self { batches, batch: Vec::new().into_iter(), end: None, ids, types, lanes })
    }

    fn next_step(&mut self, step: &mut RecordedStep) -> Result<bool> {
        let next = loop {
            match (self.batch.next(), self.end.take()) {
                (Some(next), end) => {
                    self.end = end;
                    break next;
                }
                (None, Some(end)) => return end.map(|()| false),
                (None, None) => {
                    // Without an end, its thread has panicked.
                    let batch = self.batches.recv().map_err(|_| Error::Internal(panics::last()))?;
                    (self.batch, self.end) = (batch.steps.into_iter(), batch.end);
                }
            }
        };
        for (user, id) in next.ids {
            let place = user as usize;
            if self.ids.len() <= place {
                self.ids.resize(place + 1, String::new());
            }
            self.ids[place] = id;
        }
        self.types.extend(next.types);
        self.lanes.extend(next.lanes);
        *step = next.step;
        Ok(true)
    }
}

/// Reads some steps; `known` tells how many types and lanes already have a name.
fn next_batch(recording: &mut Recording, known: &mut [usize; 2]) -> Batch {
    let mut batch = Batch::default();
    let mut rows = 0;
    while rows < ROWS && batch.steps.len() < STEPS {
        let mut step = RecordedStep::default();
        match recording.next_step(&mut step) {
            Ok(true) => {}
            outcome => {
                batch.end = Some(outcome.map(|_| ()));
                break;
            }
        }
        rows += step.rows().len();
        let users = &recording.users;
        let [types, lanes] =
            [(&users.types, known[0]), (&users.lanes, known[1])].map(|(it, from)| it.after(from).to_vec());
        *known = [known[0] + types.len(), known[1] + lanes.len()];
        let ids = users.entered().map(|(user, id)| (user, id.to_owned())).collect();
        batch.steps.push(NamedStep { step, ids, types, lanes });
    }
    batch
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Steps with the texts behind the numbers of their rows, and the message of what ends them.
    fn read(mut steps: Steps) -> (Vec<String>, String) {
        let mut step = RecordedStep::default();
        let mut found = Vec::new();
        loop {
            match steps.next_step(&mut step) {
                Ok(true) => {}
                Ok(false) => return (found, "the end".to_owned()),
                Err(error) => return (found, error.to_string()),
            }
            let rows = step.rows().iter();
            let row = |row: &RecordedRow| {
                let (id, type_name, lane) = (steps.id(row.user), steps.type_name(row), steps.lane(row.lane));
                format!(" {id} {type_name} {lane} {}", row.x)
            };
            found.push(format!("{}:{} gone {:?}", step.time, rows.map(row).collect::<String>(), step.gone()));
        }
    }

    /// A recording in which vehicles follow each other, so that their numbers are used again.
    fn recording(steps: usize, last: &str) -> Recording {
        let mut text =
            "timestep_time;vehicle_id;vehicle_x;vehicle_y;vehicle_angle;vehicle_type;vehicle_speed;vehicle_lane\n"
                .to_owned();
        for step in 0..steps {
            for vehicle in step / 3..step / 3 + 40 {
                text +=
                    &format!("{step};v{vehicle};{vehicle};{step};90;type{};10;lane{}\n", vehicle % 50, vehicle % 70);
            }
        }
        Recording::parse("tracks.csv".as_ref(), text + last).unwrap()
    }

    #[test]
    fn steps_that_are_read_ahead_are_the_same() {
        for (steps, last) in [(1, ""), (STEPS + 1, ""), (1000, ""), (300, "300;v;nowhere;0;90;car;10;lane\n")] {
            let in_place = read(Steps::InPlace(recording(steps, last)));
            let ahead = read(Steps::InPlace(recording(steps, last)).read_ahead().unwrap());
            assert_eq!(in_place.0.len(), steps);
            assert_eq!(ahead, in_place);
        }
    }

    #[test]
    fn names_read_before_are_known_ahead() {
        let mut recording = recording(9, "");
        let mut step = RecordedStep::default();
        recording.next_step(&mut step).unwrap();
        let rest = read(Steps::InPlace(recording).read_ahead().unwrap()).0;
        assert_eq!(rest[..], read(Steps::InPlace(self::recording(9, ""))).0[1..]);
    }
}
