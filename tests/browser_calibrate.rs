//! Pages of `vpost calibrate` in a browser.

use crate::browser::{Report, sheets_of};
use crate::common::{messages, run};
use crate::devtools::{Browser, View};

/// A calibration's page.
fn calibration(arguments: &[&str]) -> Report {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let page = folder.path().join("calibration.html");
    let name = page.to_str().expect("a plain path");
    let ran = run(&[&["calibrate"], arguments, &["--html", name, "-q"]].concat());
    assert!(ran.status.success(), "{}", messages(&ran));
    Report { folder, page }
}

fn positioning() -> Report {
    calibration(&["interferometer", "samples/calibration/iso230_2_muts_2022.csv", "--date", "2022-10-20"])
}

fn circles() -> Report {
    calibration(&["ballbar", "samples/calibration/ballbar_circles.csv"])
}

#[test]
fn calibrations_open_print_and_fit_a_telephone() {
    let Some(mut browser) = Browser::start() else { return };
    for (report, sections, drawings) in [(positioning(), 2, 1), (circles(), 5, 18)] {
        opens_prints_and_fits(&mut browser, &report, sections, drawings, 1..12);
    }
    browser.end();
}

/// A page of so many sections and drawings opens without a message, fits a telephone and prints on so many sheets.
pub(crate) fn opens_prints_and_fits(
    browser: &mut Browser,
    report: &Report,
    sections: usize,
    drawings: usize,
    sheets: std::ops::Range<usize>,
) {
    browser.look(View::PHONE);
    browser.open(&report.page);
    browser.was_quiet();
    let document = browser.document();
    assert_eq!(document.matches("<section ").count(), sections);
    assert_eq!(document.matches("<svg ").count(), drawings);
    // Wide tables and drawings scroll in themselves; the page does not.
    assert_eq!(browser.evaluate("document.documentElement.scrollWidth"), View::PHONE.width);
    let found = sheets_of(browser);
    assert!(sheets.contains(&found), "{found} sheets");
}
