//! Finding logs, and reading their rows one after the other.

use std::fs;
use std::path::{Path, PathBuf};

use csv::StringRecord;

use super::rows::{NUMBERS, Row, Stance};
use crate::encounter::{Kind, Severity};
use crate::log::{CONFLICTS, RUN};
use crate::{Error, Result};

/// The columns of a [`Stance`], after `ego_` and `foe_`.
const STANCE: [&str; 5] = ["x", "y", "heading", "length", "width"];

/// The logs in these folders, each a log itself or a folder with logs somewhere in it.
pub fn find(folders: &[PathBuf]) -> Result<Vec<PathBuf>> {
    let mut logs = Vec::new();
    for folder in folders {
        let before = logs.len();
        look(folder, &mut logs)?;
        if logs.len() == before {
            return Err(Error::content(folder, format!("there is no {CONFLICTS} in it")));
        }
    }
    Ok(logs)
}

fn look(folder: &Path, logs: &mut Vec<PathBuf>) -> Result<()> {
    if folder.join(CONFLICTS).is_file() {
        logs.push(folder.to_owned());
        return Ok(());
    }
    let entries = fs::read_dir(folder).map_err(|source| Error::file(folder, source))?;
    let mut folders = Vec::new();
    for entry in entries {
        let entry = entry.map_err(|source| Error::file(folder, source))?;
        // Links are not followed: they may lead in circles.
        if entry.file_type().is_ok_and(|kind| kind.is_dir()) {
            folders.push(entry.path());
        }
    }
    folders.sort();
    folders.iter().try_for_each(|folder| look(folder, logs))
}

/// A log's `run.json`; null where there is none.
pub fn record(log: &Path) -> Result<serde_json::Value> {
    let path = log.join(RUN);
    if !path.is_file() {
        return Ok(serde_json::Value::Null);
    }
    let text = fs::read_to_string(&path).map_err(|source| Error::file(&path, source))?;
    serde_json::from_str(&text).map_err(|error| Error::content(&path, format!("it is no JSON: {error}")))
}

/// Passes on the rows of a log's conflicts, in their order.
pub fn rows(log: &Path, mut take: impl FnMut(Row)) -> Result<()> {
    let path = log.join(CONFLICTS);
    let unreadable = |error: csv::Error| {
        let line = error.position().map_or(1, csv::Position::line);
        match error.into_kind() {
            csv::ErrorKind::Io(source) => Error::file(&path, source),
            csv::ErrorKind::UnequalLengths { expected_len, len, .. } => {
                Error::line(&path, line, format!("{len} cells; the first line has {expected_len}"))
            }
            kind => Error::line(&path, line, format!("{kind:?}")),
        }
    };
    let mut reader = csv::Reader::from_path(&path).map_err(unreadable)?;
    let columns = Columns::of(reader.headers().map_err(unreadable)?).map_err(|said| Error::line(&path, 1, said))?;
    let mut cells = StringRecord::new();
    while reader.read_record(&mut cells).map_err(unreadable)? {
        let line = cells.position().map_or(0, csv::Position::line);
        take(columns.row(&cells).map_err(|said| Error::line(&path, line, said))?);
    }
    Ok(())
}

/// Where in a row the columns are.
struct Columns {
    id: usize,
    ids: [usize; 2],
    kind: usize,
    severity: usize,
    lane: usize,
    collision: usize,
    numbers: Vec<usize>,
    types: Option<[usize; 2]>,
    stances: Option<[([usize; 5], usize); 2]>,
}

impl Columns {
    /// Finds them by their names.
    fn of(names: &StringRecord) -> std::result::Result<Self, String> {
        let maybe = |name: &str| names.iter().position(|known| known == name);
        let place = |name: &str| maybe(name).ok_or_else(|| format!("there is no column \"{name}\""));
        let stance = |who: &str| {
            let mut places = [0; 5];
            for (place, name) in places.iter_mut().zip(STANCE) {
                *place = maybe(&format!("{who}_{name}"))?;
            }
            Some((places, maybe(&format!("{who}_path"))?))
        };
        Ok(Self {
            id: place("id")?,
            ids: [place("ego")?, place("foe")?],
            kind: place("kind")?,
            severity: place("severity")?,
            lane: place("lane")?,
            collision: place("collision")?,
            numbers: NUMBERS.iter().map(|(name, _)| place(name)).collect::<std::result::Result<_, _>>()?,
            types: maybe("ego_type").zip(maybe("foe_type")).map(<[usize; 2]>::from),
            stances: stance("ego").zip(stance("foe")).map(|(ego, foe)| [ego, foe]),
        })
    }

    fn row(&self, cells: &StringRecord) -> std::result::Result<Row, String> {
        let cell = |place: usize| cells.get(place).unwrap_or_default();
        let number = |place: usize| match cell(place) {
            "" => Ok(None),
            text => {
                let value = text.parse::<f64>().ok().filter(|value| value.is_finite());
                value.map(Some).ok_or_else(|| format!("\"{text}\" is no number"))
            }
        };
        let among = |place: usize, names: &[&str], what: &str| {
            let found = names.iter().position(|name| *name == cell(place));
            found.map(|place| place as u8).ok_or_else(|| format!("\"{}\" is no {what}", cell(place)))
        };
        let mut numbers = [None; NUMBERS.len()];
        for (value, &place) in numbers.iter_mut().zip(&self.numbers) {
            *value = number(place)?;
        }
        let stance = |(places, path): &([usize; 5], usize)| -> std::result::Result<Stance, String> {
            let mut stance = Stance { path: cell(*path).into(), ..Stance::default() };
            for (value, &place) in stance.numbers.iter_mut().zip(places) {
                *value = number(place)?.unwrap_or_default();
            }
            Ok(stance)
        };
        let stances = match &self.stances {
            Some([ego, foe]) => Some(Box::new([stance(ego)?, stance(foe)?])),
            None => None,
        };
        Ok(Row {
            run: 0,
            id: cell(self.id).parse().map_err(|_| format!("\"{}\" is no id", cell(self.id)))?,
            kind: among(self.kind, &Kind::ALL.map(Kind::name), "kind")?,
            severity: among(self.severity, &Severity::ALL.map(Severity::name), "severity")?,
            collision: cell(self.collision) == "true",
            numbers,
            ids: self.ids.map(|place| cell(place).into()),
            types: self.types.map(|places| places.map(|place| cell(place).into())).unwrap_or_default(),
            lane: cell(self.lane).into(),
            stances,
        })
    }
}
