//! A conflict to be played: its row of the log, its clip and the net around it.

use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use rustc_hash::FxHashMap;
use serde::Serialize;

use crate::dataset::nets;
use crate::logged::{ConflictSelector, LoggedRun, record};
use crate::{Error, Result};
use closecall::detection::kind::{Kind, Severity};
use closecall::events::{Clip, MOST};
use closecall::geometry::Point;
use closecall::options::RESPONSE;
use closecall::traffic::net::Net;
use closecall::util::limits::TEXT;
use closecall::util::units::{Metre, Second};
use closecall_run::output::clips::CLIPS;
use closecall_run::output::log::RUN;
use closecall_run::output::schema::LoggedConflict;
use closecall_run::util::input_file::{self, next_line};

/// A conflict with its clip.
#[derive(Debug)]
pub struct Playback {
    /// The conflict.
    pub conflict: LoggedConflict,
    /// Where the road users around it were.
    pub clip: Clip,
    /// The net; none if the run had none, or its file is gone.
    pub net: Option<Net>,
    /// The net's file.
    pub net_file: Option<PathBuf>,
    /// What the user should know about the net.
    pub notes: Vec<String>,
    /// The response time that the run assumed, brakes included, in s.
    pub response: Second,
}

/// What sumo-gui needs to play it.
#[derive(Debug, Serialize)]
pub struct Show<'a> {
    net: Option<&'a Path>,
    clip: &'a Clip,
    kind: Kind,
    severity: Severity,
    time: Second,
    at: [Metre; 2],
    /// The ego's and the foe's predicted paths at that time, from the front bumper.
    paths: [Vec<[Metre; 2]>; 2],
}

impl Playback {
    /// Finds a conflict and its clip in a log, and reads the net from `net`, or from where the run had it.
    ///
    /// # Errors
    /// [`Error::NoConflict`], [`Error::NoWorst`] or [`Error::NoClip`]; the errors of reading the log.
    pub fn find(folder: &Path, which: ConflictSelector, net: Option<&Path>) -> Result<Self> {
        let conflict = which.find(folder)?;
        let clip = clips(folder, &[conflict.id])?.remove(&conflict.id).ok_or_else(|| no_clip(folder, &conflict))?;
        let (path, text) = record(folder)?;
        let record = serde_json::from_str::<serde_json::Value>(&text)
            .map_err(|error| Error::content(&path, error.to_string()))?;
        let ground = nets::find(net, &[folder.to_owned()], std::slice::from_ref(&record))?;
        let option = |name: &str| record.get("options")?.get(name)?.as_f64();
        let response = option("response_time").zip(option("hydraulic_delay")).map_or(RESPONSE, |(t1, t2)| t1 + t2);
        Ok(Self { conflict, clip, net: ground.net, net_file: ground.file, notes: ground.notes, response })
    }

    /// What sumo-gui needs to play it.
    pub fn show(&self) -> Show<'_> {
        let Self { conflict, clip, net_file, .. } = self;
        let LoggedConflict { kind, severity, time, x, y, .. } = *conflict;
        let paths = self.paths().map(|path| path.iter().map(|point| [point.x, point.y]).collect());
        Show { net: net_file.as_deref(), clip, kind, severity, time, at: [x, y], paths }
    }

    /// The predicted paths of both at the worst step, from the front bumper; empty if standing.
    pub(super) fn paths(&self) -> [Vec<Point>; 2] {
        let LoggedConflict { ego_x, ego_y, ego_path, foe_x, foe_y, foe_path, .. } = &self.conflict;
        [(ego_x, ego_y, ego_path), (foe_x, foe_y, foe_path)].map(|(x, y, path)| {
            let numbers = path.split(' ').filter_map(|number| number.parse::<f64>().ok()).collect::<Vec<_>>();
            let points = numbers.chunks_exact(2).map(|point| Point::new(point[0], point[1]));
            let front = x.zip(*y).map(|(x, y)| Point::new(x, y)).filter(|_| !numbers.is_empty());
            front.into_iter().chain(points).collect()
        })
    }
}

/// The file of a log's clips; that of a sweep's run is beside the data set.
fn clips_file(folder: &Path) -> Option<PathBuf> {
    let of_sweep = folder.parent().and_then(Path::parent).zip(folder.file_name());
    let beside = of_sweep.map(|(sweep, run)| sweep.join("series").join(run));
    let folders = [Some(folder.to_owned()), beside].into_iter().flatten();
    folders.map(|folder| folder.join(CLIPS)).find(|path| path.is_file())
}

/// The clips of those conflicts of a log that have one, by the conflicts' `id`.
///
/// # Errors
/// [`Error::file`] and [`Error::line`] where the file of the clips is not as a run writes it.
pub fn clips(folder: &Path, ids: &[u64]) -> Result<FxHashMap<u64, Clip>> {
    let mut found = FxHashMap::default();
    let Some(path) = clips_file(folder) else { return Ok(found) };
    let mut file = input_file::open(&path)?;
    for number in 1.. {
        if found.len() == ids.len() {
            break;
        }
        let line = next_line(&mut file, &TEXT).map_err(|error| match error.kind() {
            ErrorKind::InvalidData => Error::line(&path, number, error.to_string()),
            _ => Error::file(&path, error),
        })?;
        let Some(line) = line else { break };
        let begin = line.strip_prefix("{\"conflict\":").and_then(|rest| rest.split_once(','));
        if begin.is_some_and(|(id, _)| id.parse().is_ok_and(|id| ids.contains(&id))) {
            let clip = serde_json::from_str::<Clip>(&line).map_err(|error| error.to_string());
            let checked =
                clip.and_then(|clip| if clip.is_whole() { Ok(clip) } else { Err("no whole clip".to_owned()) });
            let clip = checked.map_err(|why| Error::line(&path, number, why))?;
            found.insert(clip.conflict, clip);
        }
    }
    Ok(found)
}

/// Whether a conflict has a clip, as far as is known without reading them.
pub fn may_have_clip(folder: &Path, run: &LoggedRun, conflict: &LoggedConflict) -> bool {
    let level = level(run);
    let is_kept = level != NO_CLIPS && !is_milder(conflict.severity, level) && !run.sets_aside(conflict);
    is_kept && clips_file(folder).is_some()
}

/// The level of a run that keeps no clips.
const NO_CLIPS: &str = "none";

/// The mildest severity of which a run kept clips, or [`NO_CLIPS`]; the record leaves out the default.
fn level(run: &LoggedRun) -> &str {
    run.options.get("log_clips").and_then(|level| level.as_str()).unwrap_or("critical")
}

fn is_milder(severity: Severity, level: &str) -> bool {
    Severity::ALL.into_iter().take_while(|known| known.name() != level).any(|known| known == severity)
}

/// Why a conflict has no clip, and how to get one.
fn no_clip(folder: &Path, conflict: &LoggedConflict) -> Error {
    let run = LoggedRun::read(folder).ok();
    let level = run.as_ref().map_or(NO_CLIPS, level).to_owned();
    let severity = conflict.severity.name();
    let is_milder = is_milder(conflict.severity, &level);
    let why = match run {
        None => format!("there is no {RUN} in the folder"),
        Some(run) if !run.complete => "its run did not reach its end".to_owned(),
        Some(_) if level == NO_CLIPS => "its run kept none; run it again without --log-clips none".to_owned(),
        Some(_) if is_milder => {
            format!(
                "it is {severity}, and its run kept clips of {level} conflicts; run it again with --log-clips {severity}"
            )
        }
        Some(run) if run.sets_aside(conflict) => {
            format!("it is not traffic's ({}); run it again with --artefacts", conflict.artefact)
        }
        Some(_) if clips_file(folder).is_none() => format!("there is no {CLIPS} in the folder"),
        Some(_) => format!("its run kept at most {MOST}; --log-clips critical, or --begin, leaves out others"),
    };
    Error::NoClip(folder.to_owned(), conflict.id, why)
}
