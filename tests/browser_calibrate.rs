//! Pages of `vpost calibrate` in a browser.

use crate::browser::{Report, browse, chromium, pictures, visit};
use crate::common::{messages, run};

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

/// How far a page reaches to the right in a frame as wide as a telephone.
pub(crate) fn width_in_a_frame(browser: &str, report: &Report, width: u32) -> u32 {
    let outside = report.folder.path().join("frame.html");
    let script = "document.getElementById('f').onload=function(){document.documentElement.setAttribute('reaches',this.contentDocument.documentElement.scrollWidth)}";
    let frame = format!(
        "<html><body><iframe id=f src='{}' width={width} height=800 style='border:0'></iframe><script>{script}</script></body></html>",
        report.page.file_name().and_then(|name| name.to_str()).expect("a plain name")
    );
    std::fs::write(&outside, frame).expect("writable");
    let (dom, _) =
        browse(browser, &outside, &["--dump-dom".to_owned(), "--allow-file-access-from-files".to_owned()]);
    let reaches = dom.split("reaches=\"").nth(1).and_then(|rest| rest.split('"').next());
    reaches.and_then(|value| value.parse().ok()).unwrap_or_else(|| panic!("no width in {}", &dom[..200]))
}

#[test]
fn calibrations_open_print_and_fit_a_telephone() {
    let Some(browser) = chromium() else {
        println!("skipped: chromium is not installed");
        return;
    };
    for (report, sections, drawings) in [(positioning(), 2, 1), (circles(), 5, 18)] {
        opens_prints_and_fits(browser, &report, sections, drawings, 1..12);
    }
}

/// A page of so many sections and drawings opens without a message, fits a telephone and prints on so many sheets.
pub(crate) fn opens_prints_and_fits(
    browser: &str,
    report: &Report,
    sections: usize,
    drawings: usize,
    sheets: std::ops::Range<usize>,
) {
    let visit = visit(browser, &report.page);
    visit.was_quiet();
    assert_eq!(visit.dom.matches("<section ").count(), sections);
    assert_eq!(visit.dom.matches("<svg ").count(), drawings);
    // Wide tables and drawings scroll in themselves; the page does not.
    assert_eq!(width_in_a_frame(browser, report, 390), 390);
    let pdf = report.folder.path().join("report.pdf");
    let more = [format!("--print-to-pdf={}", pdf.display()), "--no-pdf-header-footer".to_owned()];
    browse(browser, &report.page, &more);
    let bytes = std::fs::read(&pdf).expect("a PDF");
    let pages = bytes.windows(12).filter(|w| w == b"/Type /Page\n").count();
    assert!(sheets.contains(&pages), "{pages} pages");
}

#[test]
fn pictures_of_calibrations() {
    let Some(browser) = chromium() else {
        println!("skipped: chromium is not installed");
        return;
    };
    pictures(browser, &positioning(), "positioning");
    pictures(browser, &circles(), "ballbar");
}
