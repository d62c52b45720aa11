//! Reports in a browser: Debian's `chromium`, headless.
//!
//! No console message, no request, no script that acts, prints to PDF. Where the browser is missing the tests say that they
//! were skipped; with `CI` set they fail.

use std::path::{Path, PathBuf};

use crate::common::{messages, root, run};
use crate::devtools::{Browser, sheets_and_headings};

/// A report in a folder of its own.
pub(crate) struct Report {
    pub(crate) folder: tempfile::TempDir,
    pub(crate) page: PathBuf,
}

fn report(measurements: &str, profile: &str, more: &[&str]) -> Report {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let page = folder.path().join("report.html");
    let name = page.to_str().expect("a plain path");
    let ran = run(&[&["diagnose", measurements, "-m", profile, "--html", name], more].concat());
    assert!(ran.status.success(), "{measurements}: {}", messages(&ran));
    Report { folder, page }
}

fn stan() -> Report {
    let unseen = ["--holdout", "samples/diagnosis/stan_s500_table_2_13.csv"];
    report("samples/diagnosis/stan_s500_315.csv", "samples/diagnosis/stan_s500_tables.toml", &unseen)
}

fn backlash() -> Report {
    let unseen = ["--holdout", "samples/diagnosis/backlash_holdout.csv"];
    report("samples/diagnosis/backlash.csv", "samples/diagnosis/backlash.toml", &unseen)
}

pub(crate) fn text(path: &Path) -> String {
    crate::common::page(path)
}

/// The data that a page carries along.
pub(crate) fn data_of(page: &str) -> serde_json::Value {
    let data = page.split("type=\"application/json\">").nth(1).and_then(|t| t.split("</script>").next());
    serde_json::from_str(data.expect("a data block")).expect("JSON")
}

/// A page full of elements that try to act: none does. The page's own policy would hide a mistake, so it is tried
/// without it, too.
pub(crate) fn nothing_acted(browser: Option<Browser>, report: &Report) {
    let Some(mut browser) = browser else { return };
    let page = text(&report.page);
    let policy = page.find("<meta http-equiv").expect("a policy");
    let end = policy + page[policy..].find('>').expect("it ends") + 1;
    let unprotected = report.folder.path().join("unprotected.html");
    std::fs::write(&unprotected, format!("{}{}", &page[..policy], &page[end..])).expect("writable");
    for page in [&report.page, &unprotected] {
        browser.open(page);
        // Time for whatever begins behind the page.
        browser.evaluate("new Promise(done => requestAnimationFrame(() => setTimeout(done, 300)))");
        let document = browser.document();
        let root = document.split('>').next().unwrap_or_default();
        assert!(root.contains("<html") && !root.contains("acted"), "{root}");
        assert!(!document.contains("<img") && !document.contains("<b onmouseover"), "an element got in");
        browser.was_quiet();
    }
    browser.end();
}

#[test]
fn the_checks_of_this_test_can_fail() {
    let Some(mut browser) = Browser::start() else { return };
    let folder = tempfile::tempdir().expect("a temporary folder");
    let page = folder.path().join("bad.html");
    let bad = "<html><img src='http://127.0.0.1:9/a.png'><script>console.error('here');document.documentElement.setAttribute('acted','1')</script></html>";
    std::fs::write(&page, bad).expect("writable");
    browser.open(&page);
    let document = browser.document();
    assert!(document.contains("acted"), "{document}");
    let [console, requests] = browser.said_and_asked();
    assert!(console.iter().any(|line| line.contains("here")), "{console:?}");
    assert!(requests.iter().any(|url| url.contains("127.0.0.1:9/a.png")), "{requests:?}");
    // The log of the whole browser has it, too.
    let requests = browser.requests();
    assert!(requests.iter().any(|url| url.contains("127.0.0.1:9/a.png")), "{requests:?}");
}

#[test]
fn reports_open_without_a_message_and_without_a_request() {
    let Some(mut browser) = Browser::start() else { return };
    for report in [stan(), backlash()] {
        browser.open(&report.page);
        browser.was_quiet();
        let document = browser.document();
        let sections = document.matches("<section ").count();
        assert_eq!(sections, 12, "sections of {}", report.page.display());
        assert!(document.matches("<svg ").count() >= 9);
    }
    browser.end();
}

#[test]
fn a_report_prints_to_pdf() {
    let Some(mut browser) = Browser::start() else { return };
    browser.open(&stan().page);
    let sheets = sheets_of(&mut browser);
    assert!((3..20).contains(&sheets), "{sheets} sheets");
    browser.end();
}

/// The sheets on which the open page is printed: no heading stands alone at the foot of one.
pub(crate) fn sheets_of(browser: &mut Browser) -> usize {
    /// Margin of 15 mm, the heading itself, and a line behind it, points.
    const LOWEST: f64 = 42.5 + 14.0 + 12.0;
    let pdf = browser.printed();
    assert!(pdf.starts_with(b"%PDF-"), "no PDF");
    let (sheets, headings) = sheets_and_headings(&pdf);
    assert!(headings.len() > 1, "{} headings", headings.len());
    for (sheet, height) in headings {
        assert!(height > LOWEST, "a heading alone at the foot of sheet {}: {height} points", sheet + 1);
    }
    sheets
}

/// Names of everything that a file or an option can name, each trying to act.
#[test]
fn nothing_in_a_file_can_act() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let act = "document.documentElement.id='acted'";
    let hostile = format!("<script>{act}</script>");
    let profile = folder.path().join("machine.toml");
    let machine = format!("<img src=x onerror={act}>");
    let original = std::fs::read_to_string(root().join("samples/diagnosis/backlash.toml")).expect("a sample");
    std::fs::write(&profile, original.replace("single-900001", &machine)).expect("writable");
    let original = std::fs::read_to_string(root().join("samples/diagnosis/backlash.csv")).expect("a sample");
    let mut bytes = format!("# instrument: </script>{hostile} \"quoted\" 'and' &amp;\n").into_bytes();
    bytes.extend_from_slice(b"# \xcf\xe5\xf0\xf1\xef\xe5\xea\xf2\xe8\xe2\xe0 \x00\x1b[31m\n");
    for (at, line) in original.lines().enumerate() {
        // The file calls its column whatever it likes, and is told to pass it over.
        let line = if at == 0 { format!("{line},{hostile}") } else { format!("{line},0") };
        let line = line.replace("r3,", &format!("\"<svg/onload={act}>\","));
        let line = line.replace("r4,", "\"</script><!--\",");
        bytes.extend_from_slice(format!("{line}\n").as_bytes());
    }
    let measurements = folder.path().join("<b onmouseover=x>\"m&m.csv");
    std::fs::write(&measurements, bytes).expect("writable");
    let report = report(
        measurements.to_str().expect("a plain path"),
        profile.to_str().expect("a plain path"),
        &["--ignore-column", &hostile],
    );
    let page = text(&report.page);
    assert_eq!(page.matches("<script").count(), 1, "the data block is the only one");
    assert!(page.contains("&lt;svg/onload=") && page.contains("&lt;img src=x onerror="), "they are shown");
    assert!(
        page.contains("Перспектива \u{2400}\u{241b}[31m"),
        "Windows-1251 and control characters are shown"
    );
    nothing_acted(Browser::start(), &report);
}

#[test]
fn a_report_is_small_whole_and_the_same_each_time() {
    let (first, second) = (stan(), stan());
    let (a, b) = (text(&first.page), text(&second.page));
    assert!(a == b, "two runs differ");
    assert!(a.len() < 2_000_000, "{} bytes", a.len());
    let data = data_of(&a);
    assert_eq!(data["schema"], "vpost.diagnosis/1");
    for address in ["http://", "https://", "url(", "@import", "src="] {
        let found = a.replace("http://www.w3.org/2000/svg", "");
        assert!(!found.contains(address), "the page names {address}");
    }
}

/// A map of the STAN S500 with everything in it.
fn map() -> Report {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let page = folder.path().join("map.html");
    let name = page.to_str().expect("a plain path");
    let ran = run(&[
        "map",
        "-m",
        "machine-profiles/stan_s500.toml",
        "--grid",
        "22x22x21",
        "--plane",
        "XY=100",
        "--part-box",
        "100..220,60..140,20..60",
        "--clamp",
        "120,80,40",
        "--second-order",
        "--html",
        name,
    ]);
    assert!(ran.status.success(), "{}", messages(&ran));
    Report { folder, page }
}

#[test]
fn a_map_opens_without_a_message_is_small_and_the_same_each_time() {
    let (report, again) = (map(), map());
    let page = text(&report.page);
    assert!(page == text(&again.page), "two runs differ");
    assert!(page.len() < 3_000_000, "{} bytes for 10,164 nodes", page.len());
    let data = data_of(&page);
    assert_eq!(data["schema"], "vpost.map/1");
    assert_eq!(data["nodes"], 10_164);
    let counted: u64 =
        data["histogram"]["before"].as_array().expect("counts").iter().filter_map(|n| n.as_u64()).sum();
    assert_eq!(counted, 10_164, "the histogram counts every node");
    let Some(mut browser) = Browser::start() else { return };
    browser.open(&report.page);
    browser.was_quiet();
    let document = browser.document();
    assert_eq!(document.matches("<section ").count(), 12);
    assert_eq!(document.matches("<svg ").count(), 8);
    // Thinned in the drawing, not in the numbers: 11 of each axis, twice.
    assert_eq!(document.matches("<circle ").count(), 2 * 11 * 11 * 11);
    browser.end();
}

#[test]
fn nothing_in_a_profile_or_an_option_can_act_in_a_map() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let act = "document.documentElement.id='acted'";
    let profile = folder.path().join("<b onmouseover=x>\"m&m.toml");
    let original = std::fs::read_to_string(root().join("samples/map/kondia_like.toml")).expect("a sample");
    let machine = format!("<img src=x onerror={act}></title></script><script>{act}</script> 'q' \u{202e}gpj");
    std::fs::write(&profile, original.replace("Kondia-like (invented errors)", &machine)).expect("writable");
    let page = folder.path().join("map.html");
    let region = format!("<svg/onload={act}>\"=0..500,0..500,0..500");
    let ran = run(&[
        "map",
        "-m",
        profile.to_str().expect("a plain path"),
        "--region",
        &region,
        "--grid",
        "5x5x5",
        "--html",
        page.to_str().expect("a plain path"),
    ]);
    assert!(ran.status.success(), "{}", messages(&ran));
    let html = text(&page);
    assert_eq!(html.matches("<script").count(), 1, "the data block is the only one");
    assert!(html.contains("&lt;svg/onload=") && html.contains("&lt;img src=x onerror="), "they are shown");
    assert!(html.contains("U+202E"));
    nothing_acted(Browser::start(), &Report { folder, page });
}

/// A sample, corrected and checked.
fn check(sample: &Path, dialect: &str) -> Report {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let (page, corrected) = (folder.path().join("check.html"), folder.path().join("out.nc"));
    let plain = |path: &Path| path.to_str().expect("a plain path").to_owned();
    let (sample, corrected, name) = (plain(sample), plain(&corrected), plain(&page));
    let with = ["-m", "machine-profiles/stan_s500.toml", "--dialect", dialect, "-q"];
    let ran = run(&[&[sample.as_str(), "-o", &corrected], &with[..]].concat());
    assert!(ran.status.success(), "{}", messages(&ran));
    let ran = run(&[&["check", sample.as_str(), &corrected, "--html", &name], &with[..]].concat());
    assert!(ran.status.success(), "{}", messages(&ran));
    Report { folder, page }
}

#[test]
fn a_check_shows_the_path_and_the_worst_blocks() {
    let report = check(Path::new("samples/plate_linuxcnc.nc"), "linuxcnc");
    let page = text(&report.page);
    assert!(page.len() < 3_000_000, "{} bytes", page.len());
    let data = data_of(&page);
    assert_eq!(data["schema"], "vpost.check/1");
    // The worst line is the first of the list, with its block.
    let line = data["deviation_before_line"].as_u64().expect("a line");
    let posted = text(&root().join("samples/plate_linuxcnc.nc"));
    let block = posted.lines().nth(line as usize - 1).expect("that line");
    let first = page.split("As posted</h3>").nth(1).and_then(|t| t.split("</tr>").nth(1)).expect("a row");
    assert!(first.contains(&format!(">{line}<")) && first.contains(block.trim_end()), "{first}\n{block}");
    let Some(mut browser) = Browser::start() else { return };
    browser.open(&report.page);
    browser.was_quiet();
    // What is corrected is listed by the lines of the corrected program.
    let corrected = text(&report.folder.path().join("out.nc"));
    let list = page.split("As corrected</h3>").nth(1).expect("a list");
    let rows = list.split("<tr").skip(2).take(20).map(|row| {
        row.split("<td")
            .map(|cell| {
                let cell = cell.split('>').nth(1).unwrap_or_default();
                cell.split('<').next().unwrap_or_default().to_owned()
            })
            .skip(1)
            .collect::<Vec<_>>()
    });
    for row in rows {
        let line: usize = row[0].parse().expect("a line");
        let block = corrected.lines().nth(line - 1).expect("that line").trim_end();
        assert!(row[3].trim_end() == block, "line {line}: {row:?}, {block}");
    }
    // Before and after on one scale, and what is left on its own.
    assert_eq!(browser.document().matches("<svg ").count(), 3);
    browser.end();
}

#[test]
fn nothing_in_a_program_can_act_in_a_check() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let act = "document.documentElement.id='acted'";
    let comment = format!("(<script>{act}</script><img src=x onerror={act}> \"q\" 'a' &amp; ");
    let mut bytes = b"G21 G90 G17 G94\nG54\nG0 X0 Y0 Z50.\n".to_vec();
    for block in ["G1 Z5. F200 ", "G1 X60. Y40. ", "G1 X0. Y20. "] {
        bytes.extend_from_slice(block.as_bytes());
        bytes.extend_from_slice(comment.as_bytes());
        bytes.extend_from_slice(b"\xcf\xe5\xf0\xf1\xef\xe5\xea\xf2\xe8\xe2\xe0)\n");
    }
    bytes.extend_from_slice(b"M30\n");
    let program = folder.path().join("<b onmouseover=x>&.nc");
    std::fs::write(&program, bytes).expect("writable");
    let report = check(&program, "fanuc");
    let page = text(&report.page);
    assert_eq!(page.matches("<script").count(), 1, "the data block is the only one");
    assert!(page.contains("&lt;script&gt;") && page.contains("&lt;b onmouseover=x&gt;"), "they are shown");
    nothing_acted(Browser::start(), &report);
}
