//! Every page, in both languages: accessibility by axe-core, a telephone's width, first screens, pictures.
//!
//! axe-core (the package of that name, MPL-2.0) is no part of the project: `npm` puts it into `target/axe`. Where it cannot be
//! had the test says that it was skipped; with `CI` set it fails.

use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::OnceLock;

use crate::browser::{sheets_of, text};
use crate::browser_lathe::{LATHE, SHAFT, written_diagnosis, written_pieces};
use crate::common::{messages, root, vpost};
use crate::devtools::{Browser, View};
use crate::folders::copy;

const AXE: &str = "axe-core@4.14.1";
const STAN: &str = "machine-profiles/stan_s500.toml";
/// What its profile says, and what it does not.
const CALIBRATED: &str = "Calibration: instrument Renishaw XL-80";
const LANGUAGES: [&str; 2] = ["en", "ru"];

/// The script of axe-core, fetched where it is not there.
pub(crate) fn axe() -> Option<String> {
    let folder = root().join("target/axe");
    let script = folder.join("node_modules/axe-core/axe.min.js");
    if !script.is_file() {
        let _ = Command::new("npm")
            .args(["install", "--no-save", "--no-audit", "--no-fund", "--silent", "--prefix"])
            .arg(&folder)
            .arg(AXE)
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .status();
    }
    let found = std::fs::read_to_string(&script).ok();
    assert!(
        found.is_some() || std::env::var_os("CI").is_none(),
        "axe-core must be there where CI is set: npm install {AXE}"
    );
    found
}

/// Every kind of page in both languages, made once for all tests: who comes first makes them, others wait.
fn all_pages() -> impl Iterator<Item = PathBuf> {
    static FOLDER: OnceLock<PathBuf> = OnceLock::new();
    let folder = FOLDER.get_or_init(|| {
        let folder = made_in();
        std::fs::create_dir_all(&folder).expect("writable");
        let made =
            std::fs::File::options().append(true).create(true).open(folder.join("made")).expect("writable");
        made.lock().expect("a lock");
        if made.metadata().expect("a file").len() == 0 {
            LANGUAGES.iter().for_each(|language| pages(&folder, language));
            (&made).write_all(b"all").expect("writable");
        }
        folder
    });
    let made = |language| KINDS.map(|kind| folder.join(format!("{kind}_{language}.html")));
    LANGUAGES.into_iter().flat_map(made)
}

/// A folder of this run, of which nextest gives each test a process. What others left long ago is removed.
fn made_in() -> PathBuf {
    const OLD: std::time::Duration = std::time::Duration::from_secs(3600);
    let all = root().join("target/pictures");
    for folder in std::fs::read_dir(&all).into_iter().flatten().flatten() {
        let age =
            folder.metadata().and_then(|data| data.modified()).ok().and_then(|time| time.elapsed().ok());
        let is_pages = folder.file_name().to_string_lossy().starts_with("pages-");
        if is_pages && age.is_some_and(|age| age > OLD) {
            let _ = std::fs::remove_dir_all(folder.path());
        }
    }
    let run = std::env::var("NEXTEST_RUN_ID").unwrap_or_else(|_| std::process::id().to_string());
    all.join(format!("pages-{run}"))
}

const KINDS: [&str; 11] = [
    "map",
    "map-viewer",
    "check",
    "check-viewer",
    "diagnosis",
    "diagnosis-viewer",
    "positioning",
    "ballbar",
    "turned",
    "pieces",
    "leaning",
];

/// Every kind of page in one language.
fn pages(folder: &Path, language: &str) {
    // In the folder itself: a page shows paths as they were typed, and is the same on every computer then.
    let name_of = |path: String| path.rsplit('/').next().unwrap_or_default().to_owned();
    let make = |arguments: &[&str]| {
        let mut command = vpost();
        command.current_dir(folder).args(["--lang", language, "-q"]).args(arguments);
        let ran = command.output().expect("the command starts");
        assert!(ran.status.success(), "{arguments:?}: {}", messages(&ran));
    };
    for given in ["samples", "machine-profiles"] {
        copy(&root().join(given), &folder.join(given));
    }
    let corrected = format!("plate_{language}.nc");
    let shaft = "shaft.nc";
    std::fs::write(folder.join(shaft), SHAFT).expect("writable");
    let [lathe, parts, third] = written_pieces(folder).map(name_of);
    let made = KINDS.map(|kind| format!("{kind}_{language}.html"));
    let [
        map,
        map_viewer,
        check,
        check_viewer,
        diagnosis,
        diagnosis_viewer,
        positioning,
        ballbar,
        turned,
        pieces,
        leaning,
    ] = made.each_ref().map(String::as_str);
    let asked = ["--grid", "9x9x9", "--clamp", "120,80,40", "--second-order"];
    make(&[&["map", "-m", STAN][..], &asked, &["--html", map, "--viewer", map_viewer]].concat());
    let plate = "samples/plate_linuxcnc.nc";
    make(&[plate, "-m", STAN, "--dialect", "linuxcnc", "-o", &corrected]);
    make(&[
        "check",
        plate,
        &corrected,
        "-m",
        STAN,
        "--dialect",
        "linuxcnc",
        "--html",
        check,
        "--viewer",
        check_viewer,
    ]);
    let tables = "samples/diagnosis/stan_s500_tables.toml";
    let gaps = "samples/diagnosis/stan_s500_315.csv";
    make(&["diagnose", gaps, "-m", tables, "--html", diagnosis, "--viewer", diagnosis_viewer]);
    let runs = "samples/calibration/iso230_2_muts_2022.csv";
    make(&["calibrate", "interferometer", runs, "--date", "2022-10-20", "--html", positioning]);
    make(&["calibrate", "ballbar", "samples/calibration/ballbar_circles.csv", "--html", ballbar]);
    make(&["predict", "--lathe", shaft, "-m", LATHE, "--section", "190", "--html", turned]);
    make(&["calibrate", "turning", &parts, "-m", &lathe, "--holdout", &third, "--html", pieces]);
    let [held, leant] = written_diagnosis(folder, -30.0).map(name_of);
    make(&["diagnose", &leant, "-m", &held, "--html", leaning]);
}

/// What axe-core finds on the open page, a rule and an element in a line.
///
/// * `rules` – those that are asked for; all if empty
pub(crate) fn faults(browser: &mut Browser, axe: &str, rules: &[&str]) -> Vec<String> {
    browser.evaluate(axe);
    let only = if rules.is_empty() {
        String::new()
    } else {
        format!(", runOnly: {{ type: 'rule', values: {rules:?} }}")
    };
    let ask = format!(
        "axe.run(document, {{ resultTypes: ['violations']{only} }}).then(
        found => found.violations.flatMap(one => one.nodes.map(node => one.id + ': ' + node.html.slice(0, 120))))"
    );
    let lines = browser.evaluate(&ask);
    lines.as_array().expect("lines").iter().filter_map(|line| line.as_str().map(str::to_owned)).collect()
}

#[test]
fn no_page_has_an_accessibility_fault() {
    let (Some(mut browser), Some(axe)) = (Browser::start(), axe()) else {
        println!("skipped: chromium or axe-core cannot be had");
        return;
    };
    let folder = tempfile::tempdir().expect("a temporary folder");
    // The judge finds what is wrong: grey on grey, a picture without words, a heading of nothing.
    let bad = folder.path().join("bad.html");
    let wrong = "<!DOCTYPE html><html><head><title>t</title></head><body><main><h1>t</h1>\
        <p style='color:#aaa;background:#bbb'>grey</p><img src='data:,'><table><tr><th></th><td>1</td></tr></table></main></body></html>";
    std::fs::write(&bad, wrong).expect("writable");
    browser.open(&bad);
    let known = faults(&mut browser, &axe, &[]);
    for rule in ["html-has-lang", "color-contrast", "image-alt", "empty-table-header"] {
        assert!(known.iter().any(|fault| fault.starts_with(rule)), "{rule} is not found: {known:?}");
    }
    let known = faults(&mut browser, &axe, &COLOURS);
    assert!(known.iter().any(|fault| fault.starts_with("color-contrast")), "{known:?}");
    let mut found = Vec::new();
    for page in all_pages() {
        // What is dark differs in its colours alone.
        for (view, rules) in [(View::DESK, &[][..]), (View::DARK, &COLOURS)] {
            browser.look(View { is_calm: true, ..view });
            browser.open(&page);
            settle(&mut browser, &page);
            let name = page.file_name().expect("a name").to_string_lossy().into_owned();
            let style = if view.is_dark { "dark" } else { "light" };
            let lines = faults(&mut browser, &axe, rules);
            found.extend(lines.into_iter().map(|fault| format!("{name}, {style}: {fault}")));
        }
    }
    assert!(found.is_empty(), "{}", found.join("\n"));
    browser.end();
}

/// Rules of axe-core about colours, of those that it asks for unasked.
const COLOURS: [&str; 2] = ["color-contrast", "link-in-text-block"];

/// Waits until the page in space is drawn as it is at rest.
fn settle(browser: &mut Browser, page: &Path) {
    if is_viewer(page) {
        browser.evaluate(DRAWN);
    }
}

fn is_viewer(page: &Path) -> bool {
    page.file_name().is_some_and(|name| name.to_string_lossy().contains("viewer"))
}

/// Promised when a viewer is drawn as it is at rest, the reader wanting no motion.
pub(crate) const DRAWN: &str = "new Promise(done => {
    const look = () => document.documentElement.dataset.whole ? setTimeout(done, 300) : setTimeout(look, 20);
    look();
})";

#[test]
fn no_page_is_clipped_on_a_desk_a_telephone_or_paper() {
    let Some(mut browser) = Browser::start() else { return };
    // Its width, and how many drawings and tables reach out of what holds them.
    const WIDTHS: &str = "(() => {
        const held = [...document.querySelectorAll('.scroll')].filter(e => e.querySelector('svg, table'));
        return [document.documentElement.scrollWidth, held.filter(e => e.scrollWidth > e.clientWidth + 1).length];
    })()";
    for page in all_pages() {
        for view in [View::DESK, View::PHONE, View::PAPER] {
            browser.look(View { is_calm: true, ..view });
            browser.open(&page);
            let found = browser.evaluate(WIDTHS);
            assert_eq!(found, serde_json::json!([view.width, 0]), "{}", page.display());
        }
        // What is wrong, how bad and what to do stand above the first section, on the first screen.
        browser.look(View::DESK);
        browser.open(&page);
        let head = browser.evaluate(
            "(document.querySelector('nav') ?? document.querySelector('h1')).getBoundingClientRect().bottom",
        );
        assert!(
            head.as_f64().is_some_and(|bottom| bottom < f64::from(View::DESK.height)),
            "{}: {head}",
            page.display()
        );
        // No heading alone at the foot of a sheet; a viewer is one sheet.
        if !is_viewer(&page) {
            sheets_of(&mut browser);
        }
    }
    browser.end();
}

/// What is wrong, how bad, what to do, and how the machine was measured stand above the first section; what else a result
/// rests on stands at the end.
#[test]
fn each_page_says_where_its_numbers_come_from() {
    let folder = made_in();
    for page in all_pages().filter(|page| page.to_string_lossy().ends_with("_en.html")) {
        let name = page.file_name().expect("a name").to_string_lossy().into_owned();
        let all = text(&page);
        if is_viewer(&page) {
            assert!(all.contains(">vpost --lang en"), "{name}: which command");
            assert!(all.contains(CALIBRATED), "{name}");
            continue;
        }
        let end = all.split("id=\"provenance\"").nth(1).unwrap_or_else(|| panic!("{name}: no provenance"));
        // A calibration makes a profile and may have none to begin with.
        let is_of_profile = !(name.starts_with("positioning") || name.starts_with("ballbar"));
        assert!(!is_of_profile || end.contains("profile and its tables</dt>"), "{name}: which profile");
        for said in ["BLAKE3", "instrument", "date", "temperature", "command</dt>", "<code>vpost "] {
            assert!(end.contains(said), "{name}: {said}");
        }
        assert!(end.contains(concat!("vpost ", env!("CARGO_PKG_VERSION"))), "{name}");
        // A page is the same wherever it is written.
        assert!(!end.contains(folder.join("map_en.html").to_str().expect("plain")), "{name}");
    }
    let head = |name: &str| {
        let all = text(&folder.join(format!("{name}_en.html")));
        all.split("<nav").next().expect("a head").to_owned()
    };
    let map = head("map");
    for said in
        ["What makes most of it: E", "What to do: correct programs", "as far as the model knows", CALIBRATED]
    {
        assert!(map.contains(said), "{said}: {map}");
    }
    let check = head("check");
    for said in ["PASSED", "As posted the tool is up to", "Run the corrected program", CALIBRATED] {
        assert!(check.contains(said), "{said}: {check}");
    }
}

/// How each page is looked at. Paper is white for every reader, so it has no dark form.
const LOOKS: [(&str, View); 5] = [
    ("1400", View::DESK),
    ("1400_dark", View::DARK),
    ("390", View::PHONE),
    ("390_dark", View::DARK_PHONE),
    ("print", View::PAPER),
];

/// What a reader sees: a desk and a telephone in light and in dark, and paper, which is white whatever the reader's theme:
/// printed from a dark screen it has the same bytes. `VPOST_UPDATE_DOCS=1` writes the first screen of each into
/// `docs/img`, and whole pages into `target/pictures`, for whoever looks at them.
#[test]
fn pictures_of_every_page() {
    let Some(mut browser) = Browser::start() else { return };
    let are_kept = std::env::var_os("VPOST_UPDATE_DOCS").is_some();
    for page in all_pages() {
        let name = page.file_stem().expect("a name").to_string_lossy().into_owned();
        for (what, view) in LOOKS {
            open_as(&mut browser, &page, view);
            let seen = browser.picture();
            assert!(
                seen.starts_with(b"\x89PNG") && seen.len() > 12_000,
                "{name} {what}: {} bytes",
                seen.len()
            );
            if are_kept {
                let small = browser.small_picture();
                std::fs::write(root().join(docs_picture(&name, what)), small).expect("docs/img");
                for (k, part) in browser.whole_picture().iter().enumerate() {
                    let file = format!("target/pictures/{name}_{what}_{}.png", k + 1);
                    std::fs::write(root().join(file), part).expect("writable");
                }
            }
            if view.is_paper {
                open_as(&mut browser, &page, View { is_dark: true, ..view });
                assert!(browser.picture() == seen, "{name}: paper is not white for a reader of the dark");
            }
        }
    }
    browser.end();
}

/// Opens a page as a reader sees it who wants no motion.
fn open_as(browser: &mut Browser, page: &Path, view: View) {
    browser.look(View { is_calm: true, ..view });
    browser.open(page);
    settle(browser, page);
}

fn docs_picture(page: &str, what: &str) -> String {
    format!("docs/img/{page}_{what}.png")
}

/// None is missing, and none is left of a page that is no longer made.
#[test]
fn the_documents_hold_a_picture_of_every_page() {
    let mut wanted: Vec<String> = KINDS
        .into_iter()
        .flat_map(|kind| LANGUAGES.map(|language| format!("{kind}_{language}")))
        .flat_map(|page| LOOKS.map(|(what, _)| docs_picture(&page, what)))
        .collect();
    let mut there: Vec<String> = std::fs::read_dir(root().join("docs/img"))
        .expect("docs/img")
        .map(|file| format!("docs/img/{}", file.expect("an entry").file_name().to_string_lossy()))
        .filter(|name| name.ends_with(".png"))
        .collect();
    wanted.sort();
    there.sort();
    assert_eq!(wanted, there, "VPOST_UPDATE_DOCS=1 writes them; remove what is no longer made");
}
