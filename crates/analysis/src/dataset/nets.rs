//! The net that the conflicts are drawn on, and notes about it.

use std::io::Read;
use std::path::{Path, PathBuf};

use serde_json::Value;

use crate::Result;
use closecall::traffic::net::Net;
use closecall_run::output::input_hash::Input;
use closecall_run::util::input_file::open;

/// The root element of a net is within this many bytes; netconvert writes its options before it.
const HEAD: u64 = 1 << 16;

/// The net under the conflicts.
#[derive(Debug, Default)]
pub struct Ground {
    /// The net; none if its file is gone.
    pub net: Option<Net>,
    /// Its file.
    pub file: Option<PathBuf>,
    /// What the reader of the report should know about it.
    pub notes: Vec<String>,
}

/// One run's net file, as its `run.json` names it.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Named {
    path: PathBuf,
    sha256: String,
}

/// Reads the given net, or else the one that the first log names.
///
/// # Errors
/// An error that names the given file and what is wrong with it. If a net that a log names is gone, that is a note.
pub fn find(given: Option<&Path>, logs: &[PathBuf], records: &[Value]) -> Result<Ground> {
    let named = logs.iter().zip(records).map(|(log, record)| named(log, record)).collect::<Vec<_>>();
    let mut hashes = named.iter().flatten().map(|net| &net.sha256).collect::<Vec<_>>();
    hashes.sort();
    hashes.dedup();
    let mut ground = Ground::default();
    if hashes.len() > 1 {
        ground.notes.push(format!("The runs were made on {} different nets; the map shows one of them.", hashes.len()));
    }
    if let Some(path) = given {
        ground.net = Some(closecall_run::net::read(path)?);
        ground.file = Some(path.to_owned());
        note_change(path, &hashes, &mut ground.notes);
        return Ok(ground);
    }
    let Some(first) = named.into_iter().flatten().next() else {
        ground.notes.push("The log names no net, so the map shows none; --net gives one.".to_owned());
        return Ok(ground);
    };
    match closecall_run::net::read(&first.path) {
        Ok(net) => {
            ground.net = Some(net);
            note_change(&first.path, &[&first.sha256], &mut ground.notes);
            ground.file = Some(first.path);
        }
        Err(error) => {
            let gone = matches!(error, closecall_run::Error::File { .. });
            let what = if gone { "is not there any more" } else { "cannot be read" };
            let path = first.path.display();
            ground.notes.push(format!("The net {path} {what}, so the map shows none; --net gives another place."));
        }
    }
    Ok(ground)
}

/// Adds a note if the file is not the one that a run was made on.
fn note_change(path: &Path, hashes: &[&String], notes: &mut Vec<String>) {
    let known = Input::of(path).is_ok_and(|input| hashes.is_empty() || hashes.contains(&&input.sha256));
    if !known {
        notes.push(format!(
            "The net {} is not the file that the run was made on (its SHA-256 differs).",
            path.display()
        ));
    }
}

/// The net among a run's inputs. Its path is the one that the run was given; if no file is there, one of the same name
/// beside the log counts, as the two may have been moved together.
fn named(log: &Path, record: &Value) -> Option<Named> {
    let inputs = record.get("inputs")?.as_array()?;
    let text = |input: &Value, key: &str| input.get(key).and_then(Value::as_str).map(str::to_owned);
    let files = inputs.iter().filter_map(|input| Some((text(input, "path")?, text(input, "sha256")?)));
    let placed = files.map(|(path, sha256)| {
        let path = PathBuf::from(path);
        let beside = log.parent().zip(path.file_name()).map(|(folder, name)| folder.join(name));
        let path = if path.is_file() { path } else { beside.filter(|path| path.is_file()).unwrap_or(path) };
        Named { path, sha256 }
    });
    let mut placed = placed.collect::<Vec<_>>();
    let by_name = placed.iter().position(|file| {
        let name = file.path.to_string_lossy();
        name.ends_with(".net.xml") || name.ends_with(".net.xml.gz")
    });
    let place = by_name.or_else(|| placed.iter().position(|file| is_net(&file.path)))?;
    Some(placed.swap_remove(place))
}

/// Whether a file has the root element of a net.
fn is_net(path: &Path) -> bool {
    let mut head = Vec::new();
    let read = open(path).map(|file| file.take(HEAD).read_to_end(&mut head).is_ok());
    matches!(read, Ok(true)) && String::from_utf8_lossy(&head).contains("<net ")
}
