//! Every page, in both languages: accessibility by axe-core, a telephone's width, first screens, pictures.
//!
//! axe-core (the package of that name, MPL-2.0) is no part of the project: `npm` puts it into `target/axe`. Where it cannot be
//! had the test says that it was skipped; with `CI` set it fails.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::OnceLock;

use crate::browser::{sheets_of, text};
use crate::browser_lathe::{LATHE, SHAFT, written_diagnosis, written_pieces};
use crate::common::{messages, root, run};
use crate::devtools::{Browser, View};

const AXE: &str = "axe-core@4.14.1";
const STAN: &str = "machine-profiles/stan_s500.toml";
/// What its profile says, and what it does not.
const CALIBRATED: &str = "Calibration: instrument Renishaw XL-80";
const LANGUAGES: [&str; 2] = ["en", "ru"];

/// The script of axe-core, fetched where it is not there.
fn axe() -> Option<String> {
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

/// Every kind of page in both languages, made once for all tests.
fn all_pages() -> impl Iterator<Item = PathBuf> {
    static FOLDER: OnceLock<PathBuf> = OnceLock::new();
    let folder = FOLDER.get_or_init(|| {
        let folder = made_in();
        std::fs::create_dir_all(&folder).expect("writable");
        for language in LANGUAGES {
            pages(&folder, language);
        }
        folder
    });
    let made = |language| KINDS.map(|kind| folder.join(format!("{kind}_{language}.html")));
    LANGUAGES.into_iter().flat_map(made)
}

/// A folder of this process: runners may give each test its own. What others left long ago is removed.
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
    all.join(format!("pages-{}", std::process::id()))
}

const KINDS: [&str; 9] =
    ["map", "check", "viewer", "diagnosis", "positioning", "ballbar", "turned", "pieces", "leaning"];

/// Every kind of page in one language.
fn pages(folder: &Path, language: &str) -> Vec<PathBuf> {
    let path = |name: &str| folder.join(format!("{name}_{language}.html"));
    let plain = |path: &Path| path.to_str().expect("a plain path").to_owned();
    let make = |arguments: &[&str]| {
        let ran = run(&[&["--lang", language, "-q"], arguments].concat());
        assert!(ran.status.success(), "{arguments:?}: {}", messages(&ran));
    };
    let corrected = plain(&folder.join(format!("plate_{language}.nc")));
    let shaft = plain(&folder.join("shaft.nc"));
    std::fs::write(&shaft, SHAFT).expect("writable");
    let [lathe, parts, third] = written_pieces(folder);
    let made = KINDS.map(path);
    let [map, check, viewer, diagnosis, positioning, ballbar, turned, pieces, leaning] =
        made.each_ref().map(|page| plain(page));
    make(&["map", "-m", STAN, "--grid", "9x9x9", "--clamp", "120,80,40", "--second-order", "--html", &map]);
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
        &check,
        "--viewer",
        &viewer,
    ]);
    let tables = "samples/diagnosis/stan_s500_tables.toml";
    make(&["diagnose", "samples/diagnosis/stan_s500_315.csv", "-m", tables, "--html", &diagnosis]);
    let runs = "samples/calibration/iso230_2_muts_2022.csv";
    make(&["calibrate", "interferometer", runs, "--date", "2022-10-20", "--html", &positioning]);
    make(&["calibrate", "ballbar", "samples/calibration/ballbar_circles.csv", "--html", &ballbar]);
    make(&["predict", "--lathe", &shaft, "-m", LATHE, "--section", "190", "--html", &turned]);
    make(&["calibrate", "turning", &parts, "-m", &lathe, "--holdout", &third, "--html", &pieces]);
    let [held, leant] = written_diagnosis(folder, -30.0);
    make(&["diagnose", &leant, "-m", &held, "--html", &leaning]);
    made.to_vec()
}

/// What axe-core finds on the open page, a rule and an element in a line.
///
/// * `rules` – those that are asked for; all if empty
fn faults(browser: &mut Browser, axe: &str, rules: &[&str]) -> Vec<String> {
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
    if page.file_name().is_some_and(|name| name.to_string_lossy().starts_with("viewer")) {
        browser.evaluate(DRAWN);
    }
}

/// Promised when a viewer is drawn as it is at rest, the reader wanting no motion.
pub(crate) const DRAWN: &str = "new Promise(done => {
    const look = () => document.documentElement.dataset.whole ? setTimeout(done, 300) : setTimeout(look, 20);
    look();
})";

#[test]
fn no_page_is_clipped_on_a_telephone_or_on_paper() {
    let Some(mut browser) = Browser::start() else { return };
    // Its width, and how many drawings and tables reach out of what holds them.
    const WIDTHS: &str = "(() => {
        const held = [...document.querySelectorAll('.scroll')].filter(e => e.querySelector('svg, table'));
        return [document.documentElement.scrollWidth, held.filter(e => e.scrollWidth > e.clientWidth + 1).length];
    })()";
    for page in all_pages() {
        for view in [View::PHONE, View::PAPER] {
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
        if !page.file_name().is_some_and(|name| name.to_string_lossy().starts_with("viewer")) {
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
        if name.starts_with("viewer") {
            assert!(all.contains(CALIBRATED), "{name}");
            continue;
        }
        let end = all.split("id=\"provenance\"").nth(1).unwrap_or_else(|| panic!("{name}: no provenance"));
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

/// What a reader sees: 1400 px light and dark, 390 px, paper; whole pages in `target/pictures`. `VPOST_UPDATE_DOCS=1` writes
/// a few of them, those that the other tests do not make, into `docs/img`.
#[test]
fn pictures_of_every_page() {
    let Some(mut browser) = Browser::start() else { return };
    let pictures = root().join("target/pictures");
    let phone = View { height: 1600, ..View::PHONE };
    for page in all_pages() {
        let name = page.file_stem().expect("a name").to_string_lossy().into_owned();
        for (what, view) in
            [("1400", View::DESK), ("1400_dark", View::DARK), ("390", phone), ("print", View::PAPER)]
        {
            browser.look(View { is_calm: true, ..view });
            browser.open(&page);
            settle(&mut browser, &page);
            let seen = browser.picture(false);
            assert!(
                seen.starts_with(b"\x89PNG") && seen.len() > 12_000,
                "{name} {what}: {} bytes",
                seen.len()
            );
            let is_kept =
                what == "390" && !name.starts_with("viewer") || what == "1400" && name.ends_with("_ru");
            if is_kept && std::env::var_os("VPOST_UPDATE_DOCS").is_some() {
                std::fs::write(root().join(format!("docs/img/{name}_{what}.png")), seen).expect("docs/img");
            }
            let whole = browser.picture(true);
            std::fs::write(pictures.join(format!("{name}_{what}.png")), whole).expect("writable");
        }
    }
    browser.end();
}
