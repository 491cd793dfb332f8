//! `closecall run`: SUMO through libsumo, step by step, with the checker attached.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

use closecall::batch::sweep::Task;
use closecall::cli::progress::Progress;
use closecall::cli::{self, Ended, RunRequest, Sumo, Workers};
use closecall::detection::detector::LeftOut;
use closecall::input::sumo_files;
use closecall::output::formats::Outputs;
use closecall::output::input_hash::Input;
use closecall::output::log::Log;
use closecall::output::record::RunRecord;
use closecall::output::summary::Summary;
use closecall::run::Run;
use closecall::util::threads::Helper;
use closecall::{Error, Result};
use pyo3::exceptions::{PyKeyboardInterrupt, PyValueError};
use pyo3::prelude::*;

use crate::error::{exception, message};
use crate::interrupts::Interrupts;
use crate::paint::Painter;
use crate::pull::{self, Source};
use crate::start::{self, NetAhead};
use crate::{provenance, sweep};

/// Least time that sumo-gui shows a step: libsumo's own does not wait.
const SHOWN: Duration = Duration::from_millis(50);
/// With fewer road users than this all is done about as soon as another thread has what it needs for that.
const WORTH_A_THREAD: usize = 10;
/// SUMO's times are whole ones of it, in s.
const MILLISECOND: f64 = 1e-3;
/// What finishing a step tells: how long its parts took.
type Finished = Result<[Duration; PARTS.len() - PHASE_1]>;

/// The command `closecall`; returns its exit status.
#[pyfunction]
pub fn main(py: Python, words: Vec<OsString>) -> PyResult<u8> {
    let interrupts = Interrupts::new(py)?;
    let mut simulate = |request: &RunRequest| simulate(py, request, &interrupts);
    let mut interrupted = || interrupts.had_any();
    let mut distribute = |workers: &Workers, folder: &Path, tasks: &[&Task], ended: &mut Ended| {
        interrupts.tell();
        sweep::distribute(py, workers, folder, tasks, ended)
    };
    let sumo = Sumo {
        simulate: &mut simulate,
        distribute: &mut distribute,
        closecall: closecall(py)?,
        interrupted: &mut interrupted,
    };
    Ok(cli::main(words, Some(sumo)))
}

/// The scenario at a path, for the pytest plugin: its folder, the words of its command line to be run there, the options
/// for SUMO that end them, and its first seed.
#[pyfunction]
pub fn scenario(path: PathBuf) -> PyResult<(OsString, Vec<OsString>, Vec<String>, u32)> {
    let scenario = cli::scenario(&path).map_err(exception)?;
    let seed = scenario.settings.seeds.first().copied().unwrap_or_default();
    Ok((scenario.folder.clone().into_os_string(), scenario.words(), scenario.settings.sumo_options, seed))
}

/// The command line that starts closecall in a process of its own, which ends when its standard input does.
fn closecall(py: Python) -> PyResult<Vec<OsString>> {
    py.import("closecall._start")?.call_method1("command", ("_child",))?.extract()
}

/// Runs the scenario to its end.
fn simulate(py: Python, request: &RunRequest, interrupts: &Interrupts) -> Result<Summary> {
    let ahead = NetAhead::begin(request);
    let sumo = start::start(py, request)?;
    let result = attach(&sumo, request, ahead, interrupts);
    start::close(py, request.gui);
    interrupts.end_the_process();
    result
}

/// One run of a simulation that has been started.
struct Session<'a, 'py> {
    simulation: Simulation<'py>,
    request: &'a RunRequest,
    source: Source,
    painter: Option<Painter>,
    step_length: f64,
    spent: Spent,
    /// Whether the phases of the last step are still to be done.
    is_unfinished: bool,
    /// Finishes the last step beside SUMO's next one.
    helper: Option<Helper<Box<Run>, Finished>>,
}

/// The simulation's functions, looked up once: whatever name Python is asked for anew in every step stays in its cache of
/// attributes.
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

    /// None where it has none.
    fn end(&self) -> PyResult<Option<f64>> {
        Ok(Some(self.end.call0()?.extract()?).filter(|end| *end >= 0.0))
    }

    /// Whether anybody is still to come or to arrive.
    fn goes_on(&self) -> PyResult<bool> {
        Ok(self.expected.call0()?.extract::<i64>()? > 0)
    }
}

/// Where the time goes.
#[derive(Default)]
struct Spent {
    parts: [Duration; PARTS.len()],
}

/// The parts of a step, in their order; the last four beside SUMO's next step.
const PARTS: [&str; 8] = ["SUMO", "pull", "paths", "painting", "phase 1", "phase 2", "events", "log"];
const SUMO: usize = 0;
const PULL: usize = 1;
const PATHS: usize = 2;
const PAINTING: usize = 3;
const PHASE_1: usize = 4;

impl Spent {
    /// Adds the time since the last part ended to this one.
    fn add(&mut self, part: usize, since: &mut Instant) {
        let now = Instant::now();
        self.parts[part] += now - *since;
        *since = now;
    }

    /// Adds what finishing a step took.
    fn add_finished(&mut self, parts: [Duration; PARTS.len() - PHASE_1]) {
        self.parts[PHASE_1..].iter_mut().zip(parts).for_each(|(sum, part)| *sum += part);
    }
}

fn attach(
    sumo: &Bound<PyAny>,
    request: &RunRequest,
    ahead: Option<NetAhead>,
    interrupts: &Interrupts,
) -> Result<Summary> {
    let said = |error: PyErr| {
        let (py, path) = (sumo.py(), &request.scenario);
        match error.is_instance_of::<PyValueError>(py) {
            // That is what the bridge itself refuses.
            true => Error::content(path, message(py, &error)),
            false => Error::Refused { path: path.clone(), message: message(py, &error) },
        }
    };
    let files = provenance::files(sumo).map_err(said)?;
    for path in &files.others {
        sumo_files::check_xml(path)?;
    }
    let net = files.net.as_deref().map(|path| NetAhead::finish(ahead, path)).transpose()?.map(Arc::new);
    let mut run = Run::new(&request.options, net)?;
    run.set_threads(usize::from(request.threads).saturating_sub(1));
    pull::add_obstacles(sumo, &mut run, &request.options.obstacles).map_err(said)?;
    // Who looks at sumo-gui may do what they like there, add a rerouter too.
    if !request.gui && has_no_rerouters(sumo).map_err(said)? {
        run.set_fixed_routes(true);
    }
    let mut source = Source::new(sumo, &mut run, &request.options).map_err(said)?;
    if !request.gui {
        source.set_exclusive();
    }
    let painter = request.gui.then(|| Painter::new(sumo));
    let mut record = RunRecord {
        sumo_words: request.sumo_words.clone(),
        inputs: files.with(&request.scenario).iter().map(|path| Input::of(path)).collect::<Result<_>>()?,
        ..provenance::record(Some(sumo), request.scenario.clone(), &run, &request.options).map_err(said)?
    };
    if record.seed.is_none() && request.sumo_words.iter().any(|word| word == "--seed") {
        let message = "SUMO's option random is on, so that a seed decides nothing: leave one of the two out";
        return Err(Error::content(&request.scenario, message));
    }
    let simulation = Simulation::of(sumo).map_err(said)?;
    let (begin, end) = (simulation.time().map_err(said)?, simulation.end().map_err(said)?);
    interrupts.tell();
    let outputs = Outputs::create(&request.outputs, run.net(), &record.inputs)?;
    let log = Log::create(&request.out, request.options.log_encounters)?;
    log.write_record(&record)?;
    run.log_to(log, false);
    run.write_to(outputs);
    let mut session = Session {
        simulation,
        request,
        source,
        painter,
        step_length: record.step_length.unwrap_or_default(),
        spent: Spent::default(),
        is_unfinished: false,
        helper: if has_a_second(request.threads) { Helper::new(|run: &mut Box<Run>| finish(run)) } else { None },
    };
    let (mut run, ended) = session.steps(Box::new(run), begin, end);
    let ended = session.finish_step(&mut run).and(ended);
    let exposure = run.summary().exposure;
    let empty = ended.is_ok() && exposure.vehicles + exposure.persons == 0;
    let unusable = match &ended {
        Ok(()) if empty => {
            Some(Error::content(&request.scenario, "the scenario is empty: no road user ever enters it"))
        }
        Err(Error::Value(message)) => Some(Error::content(&request.scenario, message.clone())),
        _ => None,
    };
    if let Some(error) = unusable {
        run.discard_outputs();
        if let Some(log) = run.take_log() {
            log.discard();
        }
        return Err(error);
    }
    record.summary = run.finish(left_out(request, exposure.persons))?;
    let spent = PARTS.into_iter().zip(session.spent.parts.map(|part| part.as_secs_f64()));
    record.summary.spent = spent.filter(|(_, seconds)| *seconds > 0.0).collect();
    record.complete = ended.is_ok();
    record.error = ended.as_ref().err().map(ToString::to_string);
    if let Some(log) = run.take_log() {
        log.write_record(&record)?;
    }
    ended.map(|()| record.summary)
}

impl Session<'_, '_> {
    /// From step to step until the scenario ends.
    fn steps(&mut self, mut run: Box<Run>, begin: f64, end: Option<f64>) -> (Box<Run>, Result<()>) {
        let mut progress = Progress::new(begin, end, !self.request.quiet);
        let mut now = begin;
        loop {
            let started = Instant::now();
            let simulated;
            (run, simulated) = self.simulate(run);
            match simulated.and_then(|()| self.step(&mut run, &mut now, started)) {
                Ok(true) => {}
                Ok(false) => return (run, Ok(())),
                Err(Stop::Python(error)) => return (run, Err(self.failed(now, &error))),
                Err(Stop::Own(error)) => return (run, Err(error)),
            }
            progress.show(now, run.frame.len(), run.conflicts_so_far());
            if end.is_some_and(|end| now + MILLISECOND / 2.0 > end) {
                return (run, Ok(()));
            }
        }
    }

    /// SUMO's next step, while another thread finishes the last one: that needs nothing of SUMO any more.
    fn simulate(&mut self, run: Box<Run>) -> (Box<Run>, std::result::Result<(), Stop>) {
        let Self { simulation, spent, helper, .. } = self;
        let mut since = Instant::now();
        let mut step = || {
            simulation.py().check_signals()?;
            let stepped = simulation.step.call0().map(|_| ());
            spent.add(SUMO, &mut since);
            stepped
        };
        let (Some(helper), true) = (helper, self.is_unfinished) else { return (run, step().map_err(Stop::from)) };
        let (run, finished, stepped) = helper.beside(run, step);
        self.is_unfinished = false;
        let finished = finished.map(|parts| self.spent.add_finished(parts));
        (run, finished.map_err(Stop::from).and(stepped.map_err(Stop::from)))
    }

    /// Reads a step of SUMO's, and finishes it or leaves that for later; whether there is another.
    fn step(&mut self, run: &mut Run, now: &mut f64, started: Instant) -> std::result::Result<bool, Stop> {
        let py = self.simulation.py();
        let mut since = Instant::now();
        let time = self.source.time(py)?;
        *now = time + self.step_length;
        self.source.pull(py, run, time)?;
        self.spent.add(PULL, &mut since);
        let rows = py.detach(|| run.track_paths().to_vec());
        self.source.place(py, run, &rows)?;
        self.is_unfinished = true;
        self.spent.add(PATHS, &mut since);
        let alone = self.helper.is_none() || run.frame.len() < WORTH_A_THREAD;
        if self.painter.is_some() || alone {
            self.finish_step(run)?;
            since = Instant::now();
        }
        if let Some(painter) = &mut self.painter {
            painter.paint(py, run)?;
            py.detach(|| std::thread::sleep(SHOWN.saturating_sub(started.elapsed())));
            self.spent.add(PAINTING, &mut since);
        }
        Ok(self.simulation.goes_on()?)
    }

    /// The rest of the step under way, if that is still to be done.
    fn finish_step(&mut self, run: &mut Run) -> Result<()> {
        if std::mem::take(&mut self.is_unfinished) {
            self.spent.add_finished(self.simulation.py().detach(|| finish(run))?);
        }
        Ok(())
    }

    fn failed(&self, time: f64, error: &PyErr) -> Error {
        let py = self.simulation.py();
        if error.is_instance_of::<PyKeyboardInterrupt>(py) {
            return Error::Interrupted { time };
        }
        if error.is_instance_of::<PyValueError>(py) {
            // The one thing that the bridge itself refuses in mid-run: a type with impossible dimensions.
            return Error::Value(message(py, error));
        }
        Error::Failed { time, message: message(py, error) }
    }
}

/// Phase 1, phase 2, events and log of a step; how long each took.
fn finish(run: &mut Run) -> Finished {
    let mut ends = [Instant::now(); PARTS.len() - PHASE_1 + 1];
    run.broad_phase();
    ends[1] = Instant::now();
    run.narrow_phase();
    ends[2] = Instant::now();
    run.close_conflicts();
    ends[3] = Instant::now();
    run.write()?;
    ends[4] = Instant::now();
    Ok(std::array::from_fn(|part| ends[part + 1] - ends[part]))
}

/// Whether a step may be finished by another thread, on a processor of its own.
fn has_a_second(threads: u8) -> bool {
    threads > 1 && std::thread::available_parallelism().is_ok_and(|processors| processors.get() > 1)
}

/// Why a step was the last.
enum Stop {
    Python(PyErr),
    Own(Error),
}

impl From<PyErr> for Stop {
    fn from(error: PyErr) -> Self {
        Self::Python(error)
    }
}

impl From<Error> for Stop {
    fn from(error: Error) -> Self {
        Self::Own(error)
    }
}

fn has_no_rerouters(sumo: &Bound<PyAny>) -> PyResult<bool> {
    sumo.getattr("rerouter")?.call_method0("getIDList")?.is_empty()
}

fn left_out(request: &RunRequest, persons: u64) -> Vec<LeftOut> {
    let mut left_out = Vec::new();
    if !request.gui {
        left_out.push(LeftOut::altogether("painting", "no sumo-gui"));
    }
    if persons == 0 {
        left_out.push(LeftOut::altogether("persons", "none enters the scene"));
    }
    left_out
}
