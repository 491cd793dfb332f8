//! The style sheet of every page: the report, and statistics as HTML.

use closecall::detection::kind::Severity;
use closecall_run::output::palette::{self, Ground};

/// The sheet without the severities' colours.
const SHEET: &str = include_str!("style.css");

/// The style sheet with the severities' colours: those of a dark page where the reader prefers one, on screens.
pub(crate) fn sheet() -> String {
    let names = |ground| {
        let one = |severity: Severity| format!("--{}: {};", severity.name(), palette::hex(severity, ground));
        Severity::ALL.map(one).join(" ")
    };
    let [light, dark] = [Ground::Light, Ground::Dark].map(names);
    let dark = format!("@media screen and (prefers-color-scheme: dark) {{ :root:not([data-print]) {{ {dark} }} }}");
    format!(":root {{ {light} }}\n{dark}\n{SHEET}")
}
