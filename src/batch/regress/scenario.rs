//! A scenario: a folder with a SUMO configuration, `closecall.toml` and what is expected of it.

use std::ffi::OsString;
use std::path::{Path, PathBuf};

use serde::Deserialize;

use crate::options::OptionsFile;
use crate::util::units::{Metre, Second};
use crate::{Error, Result};

/// The name of a scenario's file of settings.
pub const SETTINGS: &str = "closecall.toml";
/// Seeds where a scenario names none: as few as the statistical test can do with at [`FALSE_ALARM`].
const SEEDS: [u32; 6] = [1, 2, 3, 4, 5, 6];
/// The chance of a false alarm, half of the 1 % that is promised: of a hundred comparisons, one at most then is likely.
const FALSE_ALARM: f64 = 0.005;

/// How strictly a scenario is compared with what is expected.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Level {
    /// Byte for byte.
    #[default]
    Exact,
    /// By a statistical test over the seeds.
    Statistics,
}

impl Level {
    /// The name in `closecall.toml` and in what is printed.
    pub fn name(self) -> &'static str {
        match self {
            Self::Exact => "exact",
            Self::Statistics => "statistics",
        }
    }
}

/// Differences of means that [`Level::Statistics`] takes for none, however sure they are: another compiler's rounding.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Tolerance {
    /// Of counts, rates and traffic, as a share of what is expected.
    pub count: f64,
    /// Of times to collision, in s.
    pub ttc: Second,
    /// Of post-encroachment times, in s.
    pub pet: Second,
    /// Of margins, in m.
    pub margin: Metre,
}

impl Default for Tolerance {
    fn default() -> Self {
        Self { count: 0.01, ttc: 0.01, pet: 0.01, margin: 0.01 }
    }
}

/// The `[regress]` table of `closecall.toml`.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Settings {
    /// How strictly to compare.
    pub level: Level,
    /// SUMO's random seeds, one run for each; none for the `seed` above the table, or 1 to 6.
    pub seeds: Vec<u32>,
    /// The SUMO configuration, relative to the folder; none for the one with the folder's name, or the only one.
    pub sumocfg: Option<PathBuf>,
    /// Options for SUMO itself.
    pub sumo_options: Vec<String>,
    /// Differences that mean nothing.
    pub tolerance: Tolerance,
    /// The chance that [`Level::Statistics`] finds a difference where there is none.
    pub false_alarm: f64,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            level: Level::Exact,
            seeds: Vec::new(),
            sumocfg: None,
            sumo_options: Vec::new(),
            tolerance: Tolerance::default(),
            false_alarm: FALSE_ALARM,
        }
    }
}

/// A scenario that can be run.
#[derive(Clone, Debug, PartialEq)]
pub struct Scenario {
    /// The folder's name.
    pub name: String,
    /// The folder, as an absolute path.
    pub folder: PathBuf,
    /// The SUMO configuration, relative to the folder.
    pub sumocfg: PathBuf,
    /// Whether the folder has a `closecall.toml`.
    pub has_settings: bool,
    /// How to run and compare it; the seeds are filled in.
    pub settings: Settings,
}

impl Scenario {
    /// Reads the scenario in a folder; `known` are the long options that a key of `closecall.toml` may name.
    ///
    /// # Errors
    /// An error that names the folder, or the file and the key in it: no such folder, no configuration, a setting that
    /// is unknown or out of its range.
    pub fn read(folder: &Path, known: &[String]) -> Result<Self> {
        Self::with_configuration(folder, None, known)
    }

    /// The scenario in a folder, or of a SUMO configuration with the settings beside it.
    ///
    /// # Errors
    /// Those of [`Scenario::read`].
    pub fn at(path: &Path, known: &[String]) -> Result<Self> {
        match (path.parent(), path.file_name()) {
            (Some(folder), Some(name)) if path.is_file() => {
                let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
                Self::with_configuration(folder, Some(PathBuf::from(name)), known)
            }
            _ => Self::read(path, known),
        }
    }

    fn with_configuration(folder: &Path, sumocfg: Option<PathBuf>, known: &[String]) -> Result<Self> {
        let folder = folder.canonicalize().map_err(|source| Error::file(folder, source))?;
        let path = folder.join(SETTINGS);
        let has_settings = path.is_file();
        let file = if has_settings { OptionsFile::read(&path, known)? } else { OptionsFile::default() };
        let mut settings = match file.regress {
            Some(table) => table.try_into().map_err(|error: toml::de::Error| {
                let key = error.to_string().lines().last().unwrap_or_default().trim().to_owned();
                let place = if key.starts_with("in `") { format!(" ({key})") } else { String::new() };
                Error::content(&path, format!("[regress]: {}{place}", error.message()))
            })?,
            None => Settings::default(),
        };
        if settings.seeds.is_empty() {
            settings.seeds = match seed_of(&file.words) {
                Some(seed) => vec![seed],
                None => SEEDS.to_vec(),
            };
        }
        check(&settings).map_err(|message| Error::content(&path, format!("[regress]: {message}")))?;
        let name = folder.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        let sumocfg = match sumocfg.or_else(|| settings.sumocfg.clone()) {
            Some(given) => given,
            None => configuration(&folder, &name)?,
        };
        let full = folder.join(&sumocfg);
        std::fs::File::open(&full).map_err(|source| Error::file(&full, source))?;
        Ok(Self { name, folder, sumocfg, has_settings, settings })
    }

    /// The command line of a run in the folder, after the program's name, up to its own options.
    pub fn words(&self) -> Vec<OsString> {
        let mut words = vec!["run".into(), self.sumocfg.clone().into_os_string()];
        if self.has_settings {
            words.extend(["--config", SETTINGS].map(OsString::from));
        }
        words
    }

    /// The same with other seeds, where there are any.
    ///
    /// # Errors
    /// [`Error::Value`] where a seed is there twice.
    pub fn with_seeds(mut self, seeds: &[u32]) -> Result<Self> {
        if !seeds.is_empty() {
            self.settings.seeds = seeds.to_vec();
            check(&self.settings).map_err(Error::Value)?;
        }
        Ok(self)
    }

    /// Where what is expected is kept.
    pub fn expected(&self) -> PathBuf {
        self.folder.join("expected")
    }
}

/// The folders of the scenarios that a path means: itself, or those in it that have a `closecall.toml`, by name.
///
/// # Errors
/// An error that names the folder where there is neither.
pub fn folders(path: &Path) -> Result<Vec<PathBuf>> {
    let is_sumocfg = |file: &Path| file.extension().is_some_and(|extension| extension == "sumocfg");
    if path.join(SETTINGS).is_file() {
        return Ok(vec![path.to_owned()]);
    }
    let entries = entries(path)?;
    let within = entries.iter().filter(|entry| entry.join(SETTINGS).is_file()).cloned().collect::<Vec<_>>();
    if !within.is_empty() {
        return Ok(within);
    }
    if entries.iter().any(|entry| is_sumocfg(entry)) {
        return Ok(vec![path.to_owned()]);
    }
    Err(Error::content(path, format!("neither a {SETTINGS} nor a .sumocfg here, and no {SETTINGS} in a folder in it")))
}

fn configuration(folder: &Path, name: &str) -> Result<PathBuf> {
    let named = PathBuf::from(format!("{name}.sumocfg"));
    if folder.join(&named).is_file() {
        return Ok(named);
    }
    let all = entries(folder)?;
    let mut found = all.iter().filter(|entry| entry.extension().is_some_and(|extension| extension == "sumocfg"));
    match (found.next().and_then(|entry| entry.file_name()), found.next()) {
        (Some(only), None) => Ok(PathBuf::from(only)),
        (None, _) => Err(Error::content(folder, "no .sumocfg here; sumocfg in [regress] may name one elsewhere")),
        (Some(_), Some(_)) => Err(Error::content(
            folder,
            format!("several .sumocfg here and no {name}.sumocfg; [regress] must say which"),
        )),
    }
}

fn entries(folder: &Path) -> Result<Vec<PathBuf>> {
    let fail = |source| Error::file(folder, source);
    let read = std::fs::read_dir(folder).map_err(fail)?;
    let mut paths = read.map(|entry| entry.map(|entry| entry.path()).map_err(fail)).collect::<Result<Vec<_>>>()?;
    paths.sort();
    Ok(paths)
}

fn seed_of(words: &[String]) -> Option<u32> {
    words.iter().find_map(|word| word.strip_prefix("--seed="))?.parse().ok()
}

/// What is wrong with the settings, if anything is.
fn check(settings: &Settings) -> std::result::Result<(), String> {
    let mut seeds = settings.seeds.clone();
    seeds.sort_unstable();
    if let Some(twice) = seeds.windows(2).find(|pair| pair[0] == pair[1]) {
        return Err(format!("seeds has {} twice", twice[0]));
    }
    if !(settings.false_alarm > 0.0 && settings.false_alarm < 1.0) {
        return Err(format!("false_alarm is {}; it must be between 0 and 1", settings.false_alarm));
    }
    let Tolerance { count, ttc, pet, margin } = settings.tolerance;
    for (name, value) in [("count", count), ("ttc", ttc), ("pet", pet), ("margin", margin)] {
        if !(value.is_finite() && value >= 0.0) {
            return Err(format!("tolerance.{name} is {value}; it must be 0 or more"));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use crate::batch::regress::scenario::*;

    fn read(toml: &str) -> Result<Scenario> {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("net.sumocfg"), "<configuration/>").unwrap();
        std::fs::write(folder.path().join(SETTINGS), toml).unwrap();
        Scenario::read(folder.path(), &["end".to_owned(), "seed".to_owned()])
    }

    #[test]
    fn without_settings_a_scenario_is_exact_with_six_seeds() {
        let scenario = read("end = 20\n").unwrap();
        assert_eq!(scenario.settings, Settings { seeds: SEEDS.to_vec(), ..Settings::default() });
        assert_eq!(scenario.sumocfg, Path::new("net.sumocfg"));
        assert_eq!(read("seed = 7\n").unwrap().settings.seeds, [7]);
    }

    #[test]
    fn a_wrong_key_is_named_with_its_file() {
        for (toml, named) in [
            ("epsilom = 1\n", "epsilom"),
            ("[regress]\nlevl = 'exact'\n", "levl"),
            ("[regress]\nlevel = 'strict'\n", "strict"),
            ("[regress]\nseeds = [1, 2, 1]\n", "seeds has 1 twice"),
            ("[regress]\nseeds = [-1]\n", "seeds"),
            ("[regress]\nfalse_alarm = 0\n", "false_alarm"),
            ("[regress.tolerance]\ntcc = 0.1\n", "tcc"),
            ("[regress]\nsumocfg = 'no.sumocfg'\n", "no.sumocfg"),
        ] {
            let message = read(toml).unwrap_err().to_string();
            assert!(message.contains(named) && !message.contains('\n'), "{toml}: {message}");
        }
    }
}
