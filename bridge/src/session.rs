//! A run attached to SUMO: its steps until the scenario ends.

use std::time::{Duration, Instant};

use closecall::Severity;
use closecall::util::threads::Helper;
use closecall_cli::RunRequest;
use closecall_cli::progress::Progress;
use closecall_run::{Error, RecordedRun, Result, Run};
use pyo3::exceptions::{PyKeyboardInterrupt, PyValueError};
use pyo3::prelude::*;

use crate::error::message;
use crate::paint::Painter;
use crate::step_times::{StepTimes, TimedPart};
use crate::sumo::{Source, Steering};

/// The least time for which sumo-gui shows a step: libsumo's own does not wait.
const SHOWN: Duration = Duration::from_millis(50);
/// How many times slower than in reality a step with a serious or critical conflict goes by.
const SLOWER: [(Severity, f64); 2] = [(Severity::Serious, 1.0), (Severity::Critical, 2.0)];
/// With fewer road users than this, handing a step to another thread takes about as long as the step.
const WORTH_A_THREAD: usize = 10;
/// SUMO's times are multiples of this, in s.
const MILLISECOND: f64 = 1e-3;

/// The result of finishing a step: the time that its parts took.
type Finished = Result<StepTimes>;

/// A run of a simulation that has been started.
pub struct Session<'a, 'py> {
    simulation: Simulation<'py>,
    request: &'a RunRequest,
    source: Source,
    painter: Option<Painter>,
    step_length: f64,
    begin: f64,
    end: Option<f64>,
    spent: StepTimes,
    /// Whether the last step is still to be finished.
    is_unfinished: bool,
    /// What drivers do wrong, in a roll-out.
    steering: Option<Steering<'py>>,
    /// Finishes the last step beside SUMO's next one.
    helper: Option<Helper<Box<RecordedRun>, Finished>>,
}

/// The simulation's functions, looked up once: Python's attribute cache keeps every name that is looked up in every step.
struct Simulation<'py> {
    step: Bound<'py, PyAny>,
    time: Bound<'py, PyAny>,
    end: Bound<'py, PyAny>,
    expected: Bound<'py, PyAny>,
}

impl<'py> Simulation<'py> {
    fn of(sumo: &Bound<'py, PyAny>) -> PyResult<Self> {
        let simulation = sumo.getattr("simulation")?;
        Ok(Self {
            step: sumo.getattr("simulationStep")?,
            time: simulation.getattr("getTime")?,
            end: simulation.getattr("getEndTime")?,
            expected: simulation.getattr("getMinExpectedNumber")?,
        })
    }

    fn py(&self) -> Python<'py> {
        self.step.py()
    }

    fn time(&self) -> PyResult<f64> {
        self.time.call0()?.extract()
    }

    /// The end of the simulation, if it has one.
    fn end(&self) -> PyResult<Option<f64>> {
        Ok(Some(self.end.call0()?.extract()?).filter(|end| *end >= 0.0))
    }

    /// Whether any road user is still to depart or to arrive.
    fn goes_on(&self) -> PyResult<bool> {
        Ok(self.expected.call0()?.extract::<i64>()? > 0)
    }
}

impl<'a, 'py> Session<'a, 'py> {
    pub fn new(
        sumo: &Bound<'py, PyAny>,
        request: &'a RunRequest,
        source: Source,
        step_length: Option<f64>,
    ) -> PyResult<Self> {
        let simulation = Simulation::of(sumo)?;
        let finish = |recorded: &mut Box<RecordedRun>| finish(&mut recorded.run);
        let steering = request.roll_out.clone().map(|asked| Steering::new(sumo, asked)).transpose()?;
        // What a driver does next depends on the step that has just ended.
        let may_help = steering.is_none() && has_second_processor(request.threads);
        Ok(Self {
            begin: simulation.time()?,
            end: simulation.end()?,
            simulation,
            request,
            source,
            painter: request.gui.map(|gui| Painter::new(sumo, gui.label, true)).transpose()?,
            step_length: step_length.unwrap_or_default(),
            spent: StepTimes::default(),
            is_unfinished: false,
            steering,
            helper: if may_help { Helper::new(finish) } else { None },
        })
    }

    /// Steps until the scenario ends; returns the run, and why it ended early if it did.
    pub fn run_to_end(&mut self, recorded: Box<RecordedRun>) -> (Box<RecordedRun>, Result<()>) {
        let (mut recorded, outcome) = self.steps(recorded);
        let finished = self.finish_step(&mut recorded.run);
        (recorded, finished.and(outcome))
    }

    /// The time that each part of the steps took.
    pub fn spent(&self) -> StepTimes {
        self.spent
    }

    fn steps(&mut self, mut recorded: Box<RecordedRun>) -> (Box<RecordedRun>, Result<()>) {
        let mut progress = Progress::new(self.begin, self.end, !self.request.quiet);
        let mut now = self.begin;
        loop {
            let started = Instant::now();
            let simulated;
            (recorded, simulated) = self.simulate(recorded);
            let run = &mut recorded.run;
            match simulated.and_then(|()| self.step(run, &mut now, started)) {
                Ok(true) => {}
                Ok(false) => return (recorded, Ok(())),
                Err(StepError::Python(error)) => return (recorded, Err(self.failed(now, &error))),
                Err(StepError::Closecall(error)) => return (recorded, Err(error)),
            }
            progress.show(now, run.frame.len(), run.closed_conflicts());
            if self.end.is_some_and(|end| now + MILLISECOND / 2.0 > end) {
                return (recorded, Ok(()));
            }
        }
    }

    /// SUMO's next step, while another thread finishes the last one, which no longer needs SUMO.
    fn simulate(&mut self, recorded: Box<RecordedRun>) -> (Box<RecordedRun>, std::result::Result<(), StepError>) {
        let Self { simulation, spent, helper, .. } = self;
        let mut since = Instant::now();
        let mut step = || {
            simulation.py().check_signals()?;
            let stepped = simulation.step.call0().map(|_| ());
            spent.add(TimedPart::Sumo, &mut since);
            stepped
        };
        let (Some(helper), true) = (helper, self.is_unfinished) else {
            return (recorded, step().map_err(StepError::from));
        };
        let (recorded, finished, stepped) = helper.beside(recorded, step);
        self.is_unfinished = false;
        let finished = finished.map(|parts| self.spent.add_all(parts));
        (recorded, finished.map_err(StepError::from).and(stepped.map_err(StepError::from)))
    }

    /// Reads a step from SUMO, and finishes it or leaves that for later; returns whether there is another step.
    fn step(&mut self, run: &mut Run, now: &mut f64, started: Instant) -> std::result::Result<bool, StepError> {
        let py = self.simulation.py();
        let mut since = Instant::now();
        let time = self.source.time(py)?;
        *now = time + self.step_length;
        self.source.pull(py, run, time)?;
        if let Some(remark) = self.source.take_remark()
            && !self.request.quiet
        {
            eprintln!("closecall: {remark}");
        }
        self.spent.add(TimedPart::Pull, &mut since);
        self.source.update_paths(py, run)?;
        self.is_unfinished = true;
        self.spent.add(TimedPart::Paths, &mut since);
        let is_alone = self.painter.is_some() || run.frame.len() < WORTH_A_THREAD;
        let is_helped = !is_alone && self.helper.as_mut().is_some_and(Helper::is_worthwhile);
        if !is_helped {
            self.finish_step(run)?;
            since = Instant::now();
        }
        if let Some(painter) = &mut self.painter {
            let worst = painter.paint(py, run, self.request.gui.and_then(|gui| gui.pause_at))?;
            let shown = shown(worst, self.step_length);
            py.detach(|| std::thread::sleep(shown.saturating_sub(started.elapsed())));
            self.spent.add(TimedPart::Painting, &mut since);
        }
        if let Some(steering) = &mut self.steering
            && steering.step(run)?
        {
            return Ok(false);
        }
        Ok(self.simulation.goes_on()?)
    }

    /// Writes what came of a roll-out beside its log.
    pub fn write_roll_out(&self) -> Result<()> {
        self.steering.as_ref().map_or(Ok(()), |steering| steering.write(&self.request.out))
    }

    /// Finishes the last step, unless that is done already.
    fn finish_step(&mut self, run: &mut Run) -> Result<()> {
        if std::mem::take(&mut self.is_unfinished) {
            let parts = self.simulation.py().detach(|| finish(run))?;
            self.spent.add_all(parts);
        }
        Ok(())
    }

    fn failed(&self, time: f64, error: &PyErr) -> Error {
        let py = self.simulation.py();
        if error.is_instance_of::<PyKeyboardInterrupt>(py) {
            return Error::Interrupted { time };
        }
        if error.is_instance_of::<PyValueError>(py) {
            // The only thing that the bridge itself refuses during a run: a type with impossible dimensions.
            return Error::Value(message(py, error));
        }
        Error::Failed { time, message: message(py, error) }
    }
}

/// Both phases, events and log of a step.
fn finish(run: &mut Run) -> Finished {
    let mut spent = StepTimes::default();
    let mut since = Instant::now();
    run.finish_step(|part| spent.add(TimedPart::Check(part), &mut since))?;
    Ok(spent)
}

/// For how long sumo-gui shows a step whose worst conflict is this severe: a critical one is over in a second or two.
fn shown(worst: Option<Severity>, step_length: f64) -> Duration {
    let slower = SLOWER.into_iter().find(|(severity, _)| Some(*severity) == worst);
    slower.map_or(SHOWN, |(_, times)| SHOWN.max(Duration::from_secs_f64(times * step_length)))
}

/// Whether another thread, on a processor of its own, may finish a step.
fn has_second_processor(threads: u8) -> bool {
    threads > 1 && std::thread::available_parallelism().is_ok_and(|processors| processors.get() > 1)
}

/// Why a step failed.
enum StepError {
    Python(PyErr),
    Closecall(Error),
}

impl From<PyErr> for StepError {
    fn from(error: PyErr) -> Self {
        Self::Python(error)
    }
}

impl From<Error> for StepError {
    fn from(error: Error) -> Self {
        Self::Closecall(error)
    }
}
