//! Old names of options. clap accepts them as hidden aliases; this file has what their user reads.

use clap::Command;

/// An option without an alias, because the file that it writes has another name too, and the option that replaces it.
const LOG_ENCOUNTERS: (&str, &str) = ("log-encounters", "log-series");

/// Which name replaces the one in a word such as `--jobs=2`, or in a setting such as `keep_all`; none unless it is an old name
/// of an option of this command.
pub fn remark(command: &Command, word: &str) -> Option<String> {
    let typed = word.split('=').next().unwrap_or_default();
    let option = typed.trim_start_matches('-').replace('_', "-");
    let is_it = |argument: &&clap::Arg| {
        let is_alias = argument.get_all_aliases().is_some_and(|old| old.contains(&&*option));
        is_alias || (option == LOG_ENCOUNTERS.0 && argument.get_long() == Some(LOG_ENCOUNTERS.1))
    };
    let present = command.get_arguments().find(is_it)?.get_long()?;
    let present = if typed.starts_with('-') { format!("--{present}") } else { present.replace('-', "_") };
    Some(format!("{typed} is now {present}; the old name still works"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::{Arg, ArgAction};

    #[test]
    fn only_an_old_name_has_a_remark_and_it_is_written_as_typed() {
        let flag = |name: &'static str| Arg::new(name).long(name).action(ArgAction::SetTrue);
        let command = Command::new("closecall").arg(flag("no-shortcuts").alias("keep-all")).arg(flag("log-series"));
        let of = |word| remark(&command, word);
        assert_eq!(of("--keep-all").as_deref(), Some("--keep-all is now --no-shortcuts; the old name still works"));
        assert_eq!(of("keep_all").as_deref(), Some("keep_all is now no_shortcuts; the old name still works"));
        assert_eq!(of("log_encounters").as_deref(), Some("log_encounters is now log_series; the old name still works"));
        assert!(
            ["--no-shortcuts", "no_shortcuts", "--log-series=csv", "--mu=paper"].iter().all(|word| of(word).is_none())
        );
    }
}
