//! What SUMO writes besides its messages: which of its options name a file, and whether a scenario has any.

use std::path::Path;

use super::sumo_files::{SumoOption, files_of, options_of};
use crate::util::input_file;

/// Options, with their other names, that name a file to be written and do not end as most of them do.
const OUTPUTS: [&str; 18] = [
    "netstate-dump",
    "netstate",
    "ndump",
    "summary",
    "tripinfo",
    "vehroutes",
    "log",
    "l",
    "log-file",
    "message-log",
    "error-log",
    "save-state.files",
    "save-state.prefix",
    "save-configuration",
    "save-config",
    "C",
    "save-template",
    "save-schema",
];
/// The same of devices and other models.
const OTHER_OUTPUTS: [&str; 4] =
    ["device.ssm.file", "device.toc.file", "pedestrian.jupedsim.wkt", "pedestrian.jupedsim.py"];
/// SUMO's option that puts something before the names of all files that it writes.
pub const PREFIX: &str = "--output-prefix";

/// Whether an option of SUMO, without its dashes, names a file that it writes.
pub fn is_output(option: &str) -> bool {
    option.ends_with("-output")
        || option.ends_with(".output")
        || OUTPUTS.contains(&option)
        || OTHER_OUTPUTS.contains(&option)
}

/// The first option that names a file to be written, of those on a command line of SUMO.
pub fn output_in(args: &[String]) -> Option<&str> {
    let options = args.iter().filter_map(|word| Some(word.strip_prefix('-')?.trim_start_matches('-')));
    let names = options.map(|option| option.split_once('=').map_or(option, |(name, _)| name));
    names.into_iter().find(|name| is_output(name))
}

/// Whether a run of this configuration with these options makes SUMO write files, and they all have the same names.
pub fn has_outputs(configuration: &Path, args: &[String]) -> bool {
    let sets_prefix = |word: &String| word.split('=').next() == Some(PREFIX);
    if args.iter().any(sets_prefix) {
        return false;
    }
    let own = options_of(configuration).unwrap_or_default();
    let is_set = |SumoOption { name, value, .. }: &SumoOption| is_output(name) && !value.is_empty();
    output_in(args).is_some() || own.iter().any(is_set) || {
        // Detectors of additional files write what their `file` names.
        let named = files_of(configuration).unwrap_or_default();
        let mut additional = named.iter().filter(|(option, _)| *option == "additional-files");
        additional.any(|(_, path)| input_file::text(path).is_ok_and(|text| text.contains("file=")))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_that_name_a_file_to_write_are_known() {
        for option in
            ["fcd-output", "device.rerouting.output", "tripinfo", "log", "save-state.files", "device.ssm.file"]
        {
            assert!(is_output(option), "{option}");
        }
        for option in ["seed", "net-file", "fcd-output.attributes", "output-prefix", "device.ssm.range", "load-state"] {
            assert!(!is_output(option), "{option}");
        }
        let args = |text: &str| text.split(' ').map(str::to_owned).collect::<Vec<_>>();
        assert_eq!(output_in(&args("--scale 2 --fcd-output=a.xml")), Some("fcd-output"));
        assert_eq!(output_in(&args("--no-warnings -l log.txt")), Some("l"));
        assert_eq!(output_in(&args("--scale 2 --fcd-output.signals")), None);
    }

    #[test]
    fn the_outputs_of_a_configuration_and_its_detectors_count() {
        let folder = tempfile::tempdir().unwrap();
        let write = |name: &str, text: &str| {
            let path = folder.path().join(name);
            std::fs::write(&path, text).unwrap();
            path
        };
        let none = write("none.sumocfg", r#"<c><input><additional-files value="a.xml"/></input></c>"#);
        let fcd = write("fcd.sumocfg", r#"<c><output><fcd-output value="f.xml"/></output></c>"#);
        write("a.xml", r#"<additional><poly id="a"/></additional>"#);
        let own_prefix = ["--output-prefix=a".to_owned()];
        assert!(!has_outputs(&none, &[]) && has_outputs(&fcd, &[]) && !has_outputs(&fcd, &own_prefix));
        write("a.xml", r#"<additional><e1Detector id="a" file="e.xml"/></additional>"#);
        assert!(has_outputs(&none, &[]));
    }
}
