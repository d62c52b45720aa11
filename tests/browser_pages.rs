//! Every page, in both languages: accessibility by axe-core, a telephone's width, first screens, pictures.
//!
//! axe-core (the package of that name, MPL-2.0) is no part of the project: `npm` puts it into `target/axe`. Where it cannot be
//! had the test says that it was skipped; with `CI` set it fails.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use crate::browser::{SPACE, browse, chromium, text};
use crate::browser_lathe::{LATHE, SHAFT, written_diagnosis, written_pieces};
use crate::common::{messages, root, run};

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
    let made =
        ["map", "check", "viewer", "diagnosis", "positioning", "ballbar", "turned", "pieces", "leaning"]
            .map(path);
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

/// What axe-core finds on a page, a rule and an element in a line.
fn faults(browser: &str, axe: &str, page: &Path, is_dark: bool) -> Vec<String> {
    const ASK: &str = "addEventListener('load', () => setTimeout(() => axe.run(document, { resultTypes: ['violations'] }).then(
        found => found.violations.flatMap(one => one.nodes.map(node => one.id + ': ' + node.html.slice(0, 120))),
        error => ['error: ' + error]).then(lines => document.documentElement.setAttribute('found', encodeURIComponent(JSON.stringify(lines)))), 300))";
    // Without the page's policy, which lets no script act; nothing of the rest is changed.
    let whole = text(page);
    let policy = whole.find("<meta http-equiv").expect("a policy");
    let end = policy + whole[policy..].find('>').expect("it ends") + 1;
    let axe = axe.replace("</script", "<\\/script");
    let copy = page.with_extension("axe.html");
    let asked = format!("{}{}<script>{axe}</script><script>{ASK}</script>", &whole[..policy], &whole[end..]);
    std::fs::write(&copy, asked).expect("writable");
    let mut more: Vec<String> = SPACE.map(str::to_owned).to_vec();
    more.extend(["--dump-dom", "--virtual-time-budget=20000", "--window-size=1400,900"].map(str::to_owned));
    more.extend(is_dark.then(|| "--blink-settings=preferredColorScheme=0".to_owned()));
    let (dom, said) = browse(browser, &copy, &more);
    let found = dom.split("found=\"").nth(1).and_then(|rest| rest.split('"').next());
    let found = found.unwrap_or_else(|| panic!("{}: axe-core says nothing: {said}", page.display()));
    serde_json::from_str(&unescaped(found)).expect("lines")
}

/// What `encodeURIComponent` wrote.
fn unescaped(text: &str) -> String {
    let mut bytes = Vec::new();
    let mut rest = text.as_bytes();
    while let Some((first, behind)) = rest.split_first() {
        let code = (*first == b'%').then(|| text_of(behind)).flatten();
        bytes.push(code.unwrap_or(*first));
        rest = if code.is_some() { &behind[2..] } else { behind };
    }
    String::from_utf8(bytes).expect("UTF-8")
}

fn text_of(hexadecimal: &[u8]) -> Option<u8> {
    u8::from_str_radix(std::str::from_utf8(hexadecimal.get(..2)?).ok()?, 16).ok()
}

#[test]
fn no_page_has_an_accessibility_fault() {
    let (Some(browser), Some(axe)) = (chromium(), axe()) else {
        println!("skipped: chromium or axe-core cannot be had");
        return;
    };
    let folder = tempfile::tempdir().expect("a temporary folder");
    // The judge finds what is wrong: grey on grey, a picture without words, a heading of nothing.
    let bad = folder.path().join("bad.html");
    let wrong = "<!DOCTYPE html><html><head><meta http-equiv=x><title>t</title></head><body><main><h1>t</h1>\
        <p style='color:#aaa;background:#bbb'>grey</p><img src='data:,'><table><tr><th></th><td>1</td></tr></table></main></body></html>";
    std::fs::write(&bad, wrong).expect("writable");
    let known = faults(browser, &axe, &bad, false);
    for rule in ["html-has-lang", "color-contrast", "image-alt", "empty-table-header"] {
        assert!(known.iter().any(|fault| fault.starts_with(rule)), "{rule} is not found: {known:?}");
    }
    let mut found = Vec::new();
    for page in LANGUAGES.iter().flat_map(|language| pages(folder.path(), language)) {
        for is_dark in [false, true] {
            let name = page.file_name().expect("a name").to_string_lossy().into_owned();
            let style = if is_dark { "dark" } else { "light" };
            found.extend(
                faults(browser, &axe, &page, is_dark)
                    .into_iter()
                    .map(|fault| format!("{name}, {style}: {fault}")),
            );
        }
    }
    assert!(found.is_empty(), "{}", found.join("\n"));
}

/// Of a page in a frame as wide as a telephone: its width, and how many drawings and tables reach out of what holds them.
fn in_a_frame(browser: &str, page: &Path) -> (u32, u32) {
    let outside = page.with_extension("frame.html");
    let script = "document.getElementById('f').onload = function () {
        const inside = this.contentDocument, held = [...inside.querySelectorAll('.scroll')].filter(e => e.querySelector('svg, table'));
        const cut = held.filter(e => e.scrollWidth > e.clientWidth + 1).length;
        document.documentElement.setAttribute('reaches', inside.documentElement.scrollWidth + ' ' + cut);
    }";
    let name = page.file_name().and_then(|name| name.to_str()).expect("a plain name");
    let frame = format!(
        "<html><body><iframe id=f src='{name}' width=390 height=800 style='border:0'></iframe><script>{script}</script></body></html>"
    );
    std::fs::write(&outside, frame).expect("writable");
    let more = ["--dump-dom", "--allow-file-access-from-files"].map(str::to_owned);
    let (dom, _) = browse(browser, &outside, &more);
    let reaches = dom.split("reaches=\"").nth(1).and_then(|rest| rest.split('"').next()).expect("widths");
    let (width, cut) = reaches.split_once(' ').expect("two numbers");
    (width.parse().expect("a number"), cut.parse().expect("a number"))
}

#[test]
fn no_page_is_clipped_on_a_telephone() {
    let Some(browser) = chromium() else {
        println!("skipped: chromium is not installed");
        return;
    };
    let folder = tempfile::tempdir().expect("a temporary folder");
    for page in LANGUAGES.iter().flat_map(|language| pages(folder.path(), language)) {
        assert_eq!(in_a_frame(browser, &page), (390, 0), "{}", page.display());
    }
}

/// What is wrong, how bad, what to do, and how the machine was measured stand above the first section; what else a result
/// rests on stands at the end.
#[test]
fn each_page_says_where_its_numbers_come_from() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    for page in pages(folder.path(), "en") {
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
        assert!(!end.contains(folder.path().join("map_en.html").to_str().expect("plain")), "{name}");
    }
    let head = |name: &str| {
        let all = text(&folder.path().join(format!("{name}_en.html")));
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

/// What a reader sees: 1400 px light and dark, 390 px, paper; in `target/pictures`. `VPOST_UPDATE_DOCS=1` writes a few of
/// them, those that the other tests do not make, into `docs/img`.
#[test]
fn pictures_of_every_page() {
    let Some(browser) = chromium() else {
        println!("skipped: chromium is not installed");
        return;
    };
    let (folder, pictures) =
        (tempfile::tempdir().expect("a temporary folder"), root().join("target/pictures"));
    std::fs::create_dir_all(&pictures).expect("writable");
    for page in LANGUAGES.iter().flat_map(|language| pages(folder.path(), language)) {
        let name = page.file_stem().expect("a name").to_string_lossy().into_owned();
        // Paper has no command line option: its styles are given to the screen. Nor is a window as narrow as a telephone.
        let paper = page.with_extension("paper.html");
        std::fs::write(&paper, text(&page).replace("@media print", "@media all")).expect("writable");
        let phone = page.with_extension("phone.html");
        let inside = page.file_name().and_then(|name| name.to_str()).expect("a plain name");
        let frame = format!(
            "<body style='margin:0'><iframe src='{inside}' width=390 height=1600 style='border:0'></iframe>"
        );
        std::fs::write(&phone, frame).expect("writable");
        let dark = "--blink-settings=preferredColorScheme=0";
        let views = [
            ("1400", &page, "1400,1000", "--light"),
            ("1400_dark", &page, "1400,1000", dark),
            ("390", &phone, "500,1600", "--light"),
            ("print", &paper, "720,1000", "--light"),
        ];
        for (view, page, size, option) in views {
            let picture = pictures.join(format!("{name}_{view}.png"));
            let mut more = SPACE.map(str::to_owned).to_vec();
            more.extend([
                format!("--window-size={size}"),
                option.to_owned(),
                format!("--screenshot={}", picture.display()),
            ]);
            browse(browser, page, &more);
            let bytes = std::fs::read(&picture).expect("a picture");
            assert!(
                bytes.starts_with(b"\x89PNG") && bytes.len() > 12_000,
                "{name} {view}: {} bytes",
                bytes.len()
            );
            let is_kept = matches!(view, "390") && !name.starts_with("viewer")
                || view == "1400" && name.ends_with("_ru");
            if is_kept && std::env::var_os("VPOST_UPDATE_DOCS").is_some() {
                std::fs::copy(&picture, root().join(format!("docs/img/{name}_{view}.png")))
                    .expect("docs/img");
            }
        }
    }
}
