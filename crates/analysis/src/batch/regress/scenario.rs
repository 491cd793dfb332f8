//! A scenario: a folder with a SUMO configuration, `closecall.toml` and the expected outcome.

use std::ffi::OsString;
use std::path::{Path, PathBuf};

use serde::Deserialize;

use crate::logged::SUMMARY;
use crate::{Error, Result};
use closecall::util::units::{Metre, Second};
use closecall_run::input::sumo_outputs::output_in;
use closecall_run::options::OptionsFile;
use closecall_run::options::RunOptions;
use closecall_run::output::formats::OutputFiles;
use closecall_run::output::log::CONFLICTS;
use closecall_run::util::input_file;

/// The name of a scenario's file of settings.
pub(crate) const SETTINGS: &str = "closecall.toml";
/// The default seeds: as few as the statistical test needs at [`FALSE_ALARM`].
const SEEDS: [u32; 6] = [1, 2, 3, 4, 5, 6];
/// The default chance of a false alarm: half of the promised 1 %, so that a hundred comparisons rarely give more than one.
const FALSE_ALARM: f64 = 0.005;

/// How strictly a scenario is compared with its expected outcome.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, strum::Display)]
#[serde(rename_all = "snake_case")]
#[strum(serialize_all = "snake_case")]
pub enum Level {
    /// Byte for byte.
    #[default]
    Exact,
    /// By a statistical test over the seeds.
    Statistics,
}

/// Differences of means that `Level::Statistics` ignores even if significant, such as those of another compiler's rounding.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Tolerance {
    /// For counts, rates and traffic, as a share of the expected mean.
    pub count: f64,
    /// For times to collision, in s.
    pub ttc: Second,
    /// For post-encroachment times, in s.
    pub pet: Second,
    /// For margins, in m.
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
pub struct RegressSettings {
    /// The level of the comparison.
    pub level: Level,
    /// SUMO's random seeds, one run each; empty for the `seed` above the table, or 1 to 6.
    pub seeds: Vec<u32>,
    /// The SUMO configuration, relative to the folder; none for the one with the folder's name, or the only one.
    pub sumocfg: Option<PathBuf>,
    /// Options for SUMO itself.
    pub sumo_options: Vec<String>,
    /// Differences to ignore.
    pub tolerance: Tolerance,
    /// The chance that `Level::Statistics` reports a difference although nothing changed.
    pub false_alarm: f64,
}

impl Default for RegressSettings {
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
    /// How to run and compare it, with the seeds filled in.
    pub settings: RegressSettings,
    /// What to tell the user of old names in `closecall.toml`.
    pub remarks: Vec<String>,
}

impl Scenario {
    /// Reads the scenario in a folder; `known` are the long options that `closecall.toml` may contain as keys.
    ///
    /// # Errors
    /// An error that names the folder, or the file and the key in it: the folder or the configuration does not exist, or a
    /// setting is unknown or out of its range.
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
        let file = if has_settings {
            OptionsFile::read(&path, known, RunOptions::check_setting)?
        } else {
            OptionsFile::default()
        };
        let is_output = |word: &&String| OutputFiles::OPTIONS.iter().any(|option| word.starts_with(option));
        if let Some(word) = file.args.iter().find(is_output) {
            let message =
                "a scenario's settings name no file to be written: give it on the command line of closecall run";
            return Err(Error::content(&path, format!("{}: {message}", word.trim_start_matches('-'))));
        }
        let mut settings = match file.regress {
            Some(table) => table.try_into().map_err(|error: toml::de::Error| {
                let key = error.to_string().lines().last().unwrap_or_default().trim().to_owned();
                let place = if key.starts_with("in `") { format!(" ({key})") } else { String::new() };
                Error::content(&path, format!("[regress]: {}{place}", error.message()))
            })?,
            None => RegressSettings::default(),
        };
        if settings.seeds.is_empty() {
            settings.seeds = match seed_of(&file.args) {
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
        input_file::file(&full)?;
        Ok(Self { name, folder, sumocfg, has_settings, settings, remarks: file.remarks })
    }

    /// The command line of a run in the folder, after the program's name, up to its own options.
    pub fn args(&self) -> Vec<OsString> {
        let mut args = vec!["run".into(), self.sumocfg.clone().into_os_string()];
        if self.has_settings {
            args.extend(["--config", SETTINGS].map(OsString::from));
        }
        args
    }

    /// The scenario with other seeds, unless `seeds` is empty.
    ///
    /// # Errors
    /// [`Error::Value`] if a seed is repeated.
    pub fn with_seeds(mut self, seeds: &[u32]) -> Result<Self> {
        if !seeds.is_empty() {
            self.settings.seeds = seeds.to_vec();
            check(&self.settings).map_err(Error::Value)?;
        }
        Ok(self)
    }

    /// The folder of the expected outcome.
    pub fn expected(&self) -> PathBuf {
        self.folder.join("expected")
    }

    /// The files that are read to run and compare it, without those that SUMO reads.
    pub fn files(&self) -> [PathBuf; 4] {
        let expected = self.expected();
        let [settings, sumocfg] = [Path::new(SETTINGS), &self.sumocfg].map(|file| self.folder.join(file));
        [settings, sumocfg, expected.join(CONFLICTS), expected.join(SUMMARY)]
    }
}

/// The folders of the scenarios at a path: the path itself, or the folders in it that have a `closecall.toml`, by name.
///
/// # Errors
/// An error that names the folder without a scenario.
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
        (None, _) => Err(Error::content(folder, "no .sumocfg here; set sumocfg in [regress] to use one elsewhere")),
        (Some(_), Some(_)) => Err(Error::content(
            folder,
            format!("several .sumocfg here and no {name}.sumocfg; set sumocfg in [regress] to choose one"),
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

fn seed_of(args: &[String]) -> Option<u32> {
    args.iter().find_map(|word| word.strip_prefix("--seed="))?.parse().ok()
}

/// Checks the settings; the error says what is wrong.
fn check(settings: &RegressSettings) -> std::result::Result<(), String> {
    let mut seeds = settings.seeds.clone();
    seeds.sort_unstable();
    if let Some(twice) = seeds.windows(2).find(|pair| pair[0] == pair[1]) {
        return Err(format!("seeds has {} twice", twice[0]));
    }
    if let Some(option) = output_in(&settings.sumo_options) {
        return Err(format!("sumo_options has --{option}, which names a file to be written"));
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
        let known = ["end", "seed", "ssm-output", "trj-output"].map(str::to_owned);
        Scenario::read(folder.path(), &known)
    }

    #[test]
    fn a_scenario_is_exact_with_six_seeds_by_default() {
        let scenario = read("end = 20\n").unwrap();
        assert_eq!(scenario.settings, RegressSettings { seeds: SEEDS.to_vec(), ..RegressSettings::default() });
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
            ("ssm-output = '/precious'\n", "ssm-output=/precious"),
            ("trj_output = 'a.trj'\n", "trj-output=a.trj"),
            ("[regress]\nsumo_options = ['--fcd-output', 'f.xml']\n", "--fcd-output"),
            ("[regress]\nfalse_alarm = 0\n", "false_alarm"),
            ("[regress.tolerance]\ntcc = 0.1\n", "tcc"),
            ("[regress]\nsumocfg = 'no.sumocfg'\n", "no.sumocfg"),
        ] {
            let message = read(toml).unwrap_err().to_string();
            assert!(message.contains(named) && !message.contains('\n'), "{toml}: {message}");
        }
    }
}
