//! The reports as JUnit XML, which CI systems read. No times of day or durations, so equal results give equal bytes.

use std::path::Path;

use super::Report;
use crate::Result;
use closecall_run::util::output_file;
use closecall_run::util::xml_text::escaped;

/// Writes the reports, one test case per scenario.
///
/// # Errors
/// `Error::File` if the file cannot be written.
pub fn write(path: &Path, reports: &[Report]) -> Result<()> {
    Ok(output_file::write(path, document(reports).as_bytes())?)
}

fn document(reports: &[Report]) -> String {
    let count = |is_one: fn(u8) -> bool| reports.iter().filter(|report| is_one(report.exit_status())).count();
    let (failures, errors) = (count(|status| status == 1), count(|status| status > 1));
    let counts = format!("tests=\"{}\" failures=\"{failures}\" errors=\"{errors}\"", reports.len());
    let cases = reports.iter().map(case).collect::<String>();
    format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites name=\"closecall regress\" {counts}>\n\
         <testsuite name=\"closecall regress\" {counts}>\n{cases}</testsuite>\n</testsuites>\n"
    )
}

fn case(report: &Report) -> String {
    let (headline, details) = (report.headline(), report.details().join("\n"));
    let (headline, details) = (escaped(&headline), escaped(&details));
    let problem = |element: &str, kind: &str| {
        format!("<{element} type=\"{kind}\" message=\"{headline}\">{headline}\n{details}</{element}>\n")
    };
    let problem = match report.exit_status() {
        0 => String::new(),
        1 => problem("failure", "difference"),
        _ => problem("error", "error"),
    };
    format!(
        "<testcase name=\"{}\" classname=\"closecall.regress\">\n{problem}<system-out>{}</system-out>\n</testcase>\n",
        escaped(&report.name),
        escaped(&report.to_string())
    )
}
