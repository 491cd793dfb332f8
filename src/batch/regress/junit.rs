//! The reports as JUnit XML, which CI systems read. No times of day or durations, so equal results give equal bytes.

use std::path::Path;

use quick_junit::{NonSuccessKind, TestCase, TestCaseStatus, TestSuite};

use super::Report;
use crate::util::output_file;
use crate::{Error, Result};

/// Writes the reports, one test case per scenario.
///
/// # Errors
/// [`Error::File`] if the file cannot be written.
pub fn write(path: &Path, reports: &[Report]) -> Result<()> {
    let text = document(reports).to_string().map_err(|error| Error::content(path, error.to_string()))?;
    output_file::write(path, text.as_bytes())
}

fn document(reports: &[Report]) -> quick_junit::Report {
    let mut suite = TestSuite::new("closecall regress");
    suite.add_test_cases(reports.iter().map(case));
    let mut document = quick_junit::Report::new("closecall regress");
    document.add_test_suite(suite);
    document
}

fn case(report: &Report) -> TestCase {
    let headline = report.headline();
    let details = report.details().join("\n");
    let kind = match report.exit_status() {
        0 => None,
        1 => Some((NonSuccessKind::Failure, "difference")),
        _ => Some((NonSuccessKind::Error, "error")),
    };
    let status = match kind {
        None => TestCaseStatus::success(),
        Some((kind, name)) => {
            let mut status = TestCaseStatus::non_success(kind);
            status.set_type(name).set_message(&headline).set_description(format!("{headline}\n{details}"));
            status
        }
    };
    let mut case = TestCase::new(report.name.clone(), status);
    case.set_classname("closecall.regress").set_system_out(format!("{report}"));
    case
}
