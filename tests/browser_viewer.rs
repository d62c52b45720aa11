//! The pages in which the error moves (`--viewer`), in a browser.

use std::fmt::Write;
use std::path::Path;

use serde_json::Value;

use crate::browser::{Report, data_of, nothing_acted, text};
use crate::browser_pages::DRAWN;
use crate::common::{messages, root, run};
use crate::devtools::{Browser, View};

const STAN: &str = "machine-profiles/stan_s500.toml";

fn plain(path: &Path) -> &str {
    path.to_str().expect("a plain path")
}

/// A program, corrected and checked.
fn check(program: &str, more: &[&str]) -> Report {
    check_on(STAN, program, more)
}

fn check_on(machine: &str, program: &str, more: &[&str]) -> Report {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let (page, corrected) = (folder.path().join("viewer.html"), folder.path().join("out.nc"));
    let with = [&["-m", machine, "--dialect", "linuxcnc", "-q"], more].concat();
    let ran = run(&[&[program, "-o", plain(&corrected)], &with[..]].concat());
    assert!(ran.status.success(), "{}", messages(&ran));
    let ran = run(&[&["check", program, plain(&corrected), "--viewer", plain(&page)], &with[..]].concat());
    assert!(ran.status.success(), "{}", messages(&ran));
    Report { folder, page }
}

fn plate() -> Report {
    check("samples/plate_linuxcnc.nc", &[])
}

fn map() -> Report {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let page = folder.path().join("map.html");
    let ran = run(&["map", "-m", STAN, "--grid", "9x9x9", "--viewer", plain(&page)]);
    assert!(ran.status.success(), "{}", messages(&ran));
    Report { folder, page }
}

fn diagnosis() -> Report {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let page = folder.path().join("diagnosis.html");
    let measurements =
        ["samples/diagnosis/stan_s500_315.csv", "-m", "samples/diagnosis/stan_s500_tables.toml"];
    let ran = run(&[&["diagnose"], &measurements[..], &["--viewer", plain(&page)]].concat());
    assert!(ran.status.success(), "{}", messages(&ran));
    Report { folder, page }
}

/// Runs a script in a page as a reader would act on it, and gives what it finds: `$` finds by id, `key` presses a key in the
/// drawing, `go` moves the slider, `frames` waits for drawn ones, `say` ends with a value.
fn act(browser: &mut Browser, report: &Report, script: &str) -> Value {
    const HANDS: &str = "new Promise((say, fail) => {
        const $ = id => document.getElementById(id);
        const key = (name, more) => $('view').dispatchEvent(new KeyboardEvent('keydown', { key: name, bubbles: true, cancelable: true, ...more }));
        const go = i => { $('at').value = i; $('at').dispatchEvent(new Event('input')); };
        const frames = (count, then) => (count ? requestAnimationFrame(() => frames(count - 1, then)) : then());
        window.onerror = message => fail(new Error(message));
        SCRIPT
    })";
    browser.look(View { width: 1200, height: 800, is_calm: true, ..View::DESK });
    browser.open(&report.page);
    browser.evaluate(DRAWN);
    browser.evaluate(&HANDS.replace("SCRIPT", script))
}

#[test]
fn viewers_are_quiet_drawn_and_fit_a_telephone() {
    let Some(mut browser) = Browser::start_in_space() else { return };
    // How many pixels have the colours of the real path and of the other one.
    let count = "key('ArrowLeft'); requestAnimationFrame(() => {
        const c = document.createElement('canvas'), from = $('canvas');
        [c.width, c.height] = [from.width, from.height];
        const x = c.getContext('2d'); x.drawImage(from, 0, 0);
        const p = x.getImageData(0, 0, c.width, c.height).data;
        let [warm, cold] = [0, 0];
        for (let i = 0; i < p.length; i += 4) if (p[i + 3] > 99) { if (p[i] > p[i + 2] + 60) warm++; else if (p[i + 2] > p[i] + 60) cold++; }
        say([warm, cold]);
    });";
    for report in [plate(), map(), diagnosis()] {
        // On a telephone, the error growing to its magnified size.
        browser.look(View::PHONE);
        browser.open(&report.page);
        browser.evaluate(DRAWN);
        browser.was_quiet();
        let document = browser.document();
        let root = document.split('>').next().unwrap_or_default();
        assert!(root.contains("data-webgl=\"yes\"") && root.contains("data-drawn"), "{root}");
        assert_eq!(browser.evaluate("document.documentElement.scrollWidth"), View::PHONE.width);
        let pixels = act(&mut browser, &report, count);
        let [warm, cold] = [0, 1].map(|k| pixels[k].as_u64().expect("a count"));
        assert!(warm > 500 && cold > 500, "{}: {pixels}", report.page.display());
    }
    browser.end();
}

#[test]
fn the_picked_line_is_the_block_with_its_figures() {
    let report = plate();
    let page = text(&report.page);
    let data = data_of(&page);
    assert_eq!(data["schema"], "vpost.viewer/1");
    assert!(page.len() < 1_000_000, "{} bytes", page.len());
    // But for the folder of the corrected program, which is another one each time.
    let anywhere = |report: &Report| text(&report.page).replace(plain(report.folder.path()), "");
    assert!(anywhere(&report) == anywhere(&plate()), "two runs differ");
    let places = data["places"].as_u64().expect("a count");
    let Some(mut browser) = Browser::start() else { return };
    let script = format!(
        "const found = [];
        for (let k = 0; k < 40; k++) {{
            const i = Math.round(k * ({places} - 1) / 39); go(i);
            found.push([$('line').textContent, $('block').textContent, $('place').textContent, $('r3').textContent, $('a3').textContent]);
        }}
        go({places} - 1); go(0);
        const at = [$('foot').getAttribute('cx'), $('foot').getAttribute('cy')].map(Number);
        frames(2, () => {{
            const box = $('view').getBoundingClientRect();
            const spot = [$('foot').getAttribute('cx'), $('foot').getAttribute('cy')].map(Number);
            go({places} - 1);
            for (const type of ['pointerdown', 'pointerup'])
                $('view').dispatchEvent(new PointerEvent(type, {{ pointerId: 7, clientX: box.left + spot[0], clientY: box.top + spot[1], bubbles: true }}));
            say({{ found, picked: $('line').textContent, left: Number($('after_most').dataset.drawn), said: $('after_most').textContent, first: found[0][0] }});
        }});"
    );
    let value = act(&mut browser, &report, &script);
    let posted = text(&root().join("samples/plate_linuxcnc.nc"));
    let lines: Vec<&str> = posted.lines().collect();
    for row in value["found"].as_array().expect("rows") {
        let line: usize = row[0]
            .as_str()
            .and_then(|title| title.strip_prefix("Line "))
            .expect("a line")
            .parse()
            .expect("a number");
        assert_eq!(row[1].as_str().expect("a block"), lines[line - 1].trim_end(), "line {line}");
        // The place is where that block leads, or on the way there: an axis that it names stands between.
        assert!(row[2].as_str().is_some_and(|place| place.starts_with("X\u{a0}")), "{row}");
    }
    assert_eq!(value["picked"], value["first"], "a pointer picks what lies under it");
    // What is left is drawn no larger than the check found it, and not much smaller.
    let [left, found] =
        [&value["left"], &data["values"]["after"]].map(|number| number.as_f64().expect("a number"));
    assert!(left <= found + 0.02 && left > 0.8 * found, "{left} drawn, {found} found");
    // One page has one answer: what the check found stands beside the drawing, too.
    assert_eq!(value["said"], format!("up to {found:.2}\u{a0}\u{b5}m"));
}

/// What is shown without a cause is what the machine does without it: the same program on a machine that has not got it.
#[test]
fn a_cause_that_is_switched_off_is_gone() {
    let Some(mut browser) = Browser::start() else { return };
    let folder = tempfile::tempdir().expect("a temporary folder");
    let original = text(&root().join(STAN));
    let tables = root().join("machine-profiles").display().to_string();
    let squareness = original.lines().find(|line| line.starts_with("EC0Y_urad")).expect("a squareness");
    let changed = original
        .replace(squareness, "EC0Y_urad = 0.0")
        .replace("\"stan_s500/", &format!("\"{tables}/stan_s500/"));
    assert_ne!(original, changed);
    let square = folder.path().join("square.toml");
    std::fs::write(&square, changed).expect("writable");

    let crooked = plate();
    // The corrected program of the other machine is another; the posted one is the same, and so are its places.
    let without = check_on(plain(&square), "samples/plate_linuxcnc.nc", &[]);
    let read = "const found = [...Array(12).keys()].map(k => { go(Math.round(k * Number($('at').max) / 11)); return [$('line').textContent, $('place').textContent, ...[0, 1, 2].map(a => $('r' + a).textContent)]; });";
    let off = format!(
        "document.querySelector('[data-symbol=EC0Y]').click(); {read} say([found, $('seen').textContent]);"
    );
    let one = act(&mut browser, &crooked, &off);
    assert!(one[1].as_str().is_some_and(|said| said.contains("squareness EC0Y")), "{}", one[1]);
    let number = |value: &Value| -> f64 {
        value.as_str().expect("a number").replace('\u{2212}', "-").parse().expect("a number")
    };
    // Interpolated places may differ: the line is looked for.
    let all = act(
        &mut browser,
        &without,
        "const found = []; for (let i = 0; i <= Number($('at').max); i++) { go(i); found.push([$('line').textContent, $('place').textContent, ...[0, 1, 2].map(a => $('r' + a).textContent)]); } say(found);",
    );
    let mut compared = 0;
    for row in one[0].as_array().expect("rows") {
        let same =
            all.as_array().expect("rows").iter().find(|other| other[0] == row[0] && other[1] == row[1]);
        let Some(same) = same else { continue };
        compared += 1;
        for axis in 2..5 {
            // Three digits are shown.
            let [a, b] = [number(&row[axis]), number(&same[axis])];
            assert!((a - b).abs() <= 0.011f64.max(0.006 * b.abs()), "{row} {same}");
        }
    }
    assert!(compared >= 8, "{compared} places are in both pages");
}

/// Each cause, the rows aligned: together they are what the diagnosis says that they explain.
#[test]
fn causes_of_a_diagnosis_add_up_to_what_they_explain() {
    let report = diagnosis();
    let data = data_of(&text(&report.page));
    let remainder = data["values"]["remainder"].as_f64().expect("a number");
    let Some(mut browser) = Browser::start() else { return };
    let left = act(&mut browser, &report, "say($('after_most').textContent.split(/\\s/)[2]);");
    let left: f64 = left.as_str().and_then(|text| text.parse().ok()).expect("a number");
    assert!(left > 10.0 && (remainder - left).abs() < 0.1, "{remainder} {left}");
}

#[test]
fn the_keyboard_alone_suffices() {
    let Some(mut browser) = Browser::start() else { return };
    let report = plate();
    let script = "
        const tip = () => ['cx', 'cy'].map(name => Number($('tip').getAttribute(name)));
        const states = {}, lines = [];
        const steps = [['turned', 'ArrowLeft'], ['moved', 'ArrowRight', { shiftKey: true }], ['near', '+'], ['top', '2']];
        const next = () => {
            const step = steps.shift();
            if (!step) return rest();
            const before = tip(); key(step[1], step[2]);
            frames(2, () => { states[step[0]] = [before, tip()]; next(); });
        };
        const rest = () => {
            for (const k of ['.', '.', ',', 'w']) { key(k); lines.push($('line').textContent); }
            key(' '); const playing = $('play').getAttribute('aria-pressed'); key(' ');
            key('m'); const swinging = $('swing').getAttribute('aria-pressed'); key('m');
            // Everything that can be acted on is reached by the Tab key, has a name, and is a control that knows keys itself.
            const controls = [...document.querySelectorAll('button,input,summary,a[href],#view')].filter(c => c.getClientRects().length);
            const nameless = controls.filter(c => !(c.getAttribute('aria-label') || c.textContent.trim() || (c.labels && c.labels[0] && c.labels[0].textContent.trim())));
            say({ states, lines, playing, swinging, count: controls.length, unreachable: controls.filter(c => c.tabIndex < 0).length, nameless: nameless.map(c => c.id) });
        };
        next();";
    let found = act(&mut browser, &report, script);
    for (what, places) in found["states"].as_object().expect("states") {
        assert_ne!(places[0], places[1], "{what}");
    }
    let lines = &found["lines"];
    assert!(lines[0] != lines[1] && lines[0] == lines[2], "{lines}");
    assert_eq!(lines[3], "Line 22", "the largest displacement");
    assert_eq!((&found["playing"], &found["swinging"]), (&Value::from("true"), &Value::from("true")));
    assert!(found["count"].as_u64().is_some_and(|count| count > 30), "{found}");
    assert_eq!(
        (&found["unreachable"], &found["nameless"]),
        (&Value::from(0), &Value::from(Vec::<Value>::new()))
    );
}

#[test]
fn without_webgl_a_drawing_with_the_same_words_and_without_a_script_too() {
    let report = plate();
    let page = text(&report.page);
    // The drawing that needs no script.
    assert_eq!(page.matches("<figure class=\"still\"").count(), 1);
    assert!(
        page.contains("As posted the tool leaves its path by up to 180\u{a0}\u{b5}m"),
        "the heading is in the text"
    );
    let Some(mut browser) = Browser::start() else { return };
    let Some(mut flat) = Browser::start_without_space() else { return };
    let words = "const all = [...document.querySelectorAll('h1,h2,.legend,#causes,#seen')].map(e => e.textContent); const before = document.querySelector('.way.real')?.getAttribute('d'); key('ArrowLeft'); frames(2, () => say({ webgl: document.documentElement.dataset.webgl, all, before, after: document.querySelector('.way.real')?.getAttribute('d') }));";
    let [with, without] = [&mut browser, &mut flat].map(|browser| act(browser, &report, words));
    assert_eq!((&with["webgl"], &without["webgl"]), (&Value::from("yes"), &Value::from("no")));
    assert_eq!(with["all"], without["all"], "the same words");
    let [before, after] = [&without["before"], &without["after"]].map(|way| way.as_str().expect("a path"));
    assert!(before.len() > 2000 && before != after, "{} {}", before.len(), after.len());
    flat.was_quiet();
    browser.end();
    flat.end();
}

#[test]
fn it_speaks_russian_where_asked() {
    let report = check("samples/plate_linuxcnc.nc", &["--lang", "ru"]);
    let page = text(&report.page);
    assert!(
        page.contains("<html lang=\"ru\">")
            && page.contains("По исходной программе инструмент отходит от траектории до")
    );
    let Some(mut browser) = Browser::start() else { return };
    let script = "const first = $('line').textContent + ' ' + $('real_most').textContent; $('en').click(); say([first, document.documentElement.lang, $('line').textContent]);";
    let found = act(&mut browser, &report, script);
    assert_eq!(found, serde_json::json!(["Строка 22 до 180\u{a0}мкм", "en", "Line 22"]));
}

#[test]
fn nothing_in_a_program_can_act_in_a_viewer() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let act = "document.documentElement.id='acted'";
    let mut program = "G21 G90 G17 G94\nG54\nG0 X0 Y0 Z50.\n".to_owned();
    for block in ["G1 Z5. F200", "G1 X60. Y40.", "G1 X0. Y20."] {
        let _ = writeln!(
            program,
            "{block} (</script><script>{act}</script><img src=x onerror={act}> \"q\" <!-- \u{202e})"
        );
    }
    program.push_str("M30\n");
    let path = folder.path().join("<b onmouseover=x>&.nc");
    std::fs::write(&path, program).expect("writable");
    let report = check(plain(&path), &[]);
    let page = text(&report.page);
    assert_eq!(page.matches("<script").count(), 3, "data, places and the script are the only ones");
    assert!(page.contains("script-src 'sha256-") && !page.contains("unsafe"), "the policy names it");
    nothing_acted(Browser::start_in_space(), &report);
}

#[test]
fn what_cannot_be_drawn_is_refused() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = |name: &str, text: &str| {
        let path = folder.path().join(name);
        std::fs::write(&path, text).expect("writable");
        path
    };
    let page = folder.path().join("viewer.html");
    let refused = |program: &Path| {
        let ran = run(&[
            "check",
            plain(program),
            plain(program),
            "-m",
            STAN,
            "--dialect",
            "linuxcnc",
            "-q",
            "--viewer",
            plain(&page),
        ]);
        assert_eq!(ran.status.code(), Some(2), "{}", messages(&ran));
        assert!(!page.exists());
        messages(&ran)
    };
    let still = file("rapids.nc", "G21 G90\nG54\nG0 X10 Y10 Z50\nG0 X20\nM2\n");
    let said = refused(&still);
    assert!(said.contains("VP1202") && said.contains("feeds nowhere"), "{said}");
    // To and fro through the whole volume, never twice the same way.
    let mut program = "G21 G90 G17 G94\nG54\nG0 X0 Y0 Z50\nG1 F1000\n".to_owned();
    for k in 1..45_000u32 {
        let at = |step: f64, size: f64| size * (f64::from(k) * step).fract();
        let _ = writeln!(
            program,
            "X{:.3} Y{:.3} Z{:.3}",
            at(0.618_034, 10.0),
            at(0.754_877, 10.0),
            at(0.569_84, 10.0)
        );
    }
    program.push_str("M2\n");
    let said = refused(&file("everywhere.nc", &program));
    assert!(said.contains("VP1201") && said.contains("a page holds"), "{said}");
}

/// One million blocks: a surface, finished line by line.
#[test]
fn a_million_blocks_are_less_than_three_megabytes_and_drawn() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let program = folder.path().join("million.nc");
    let mut nc = "G21 G90 G17 G94\nG54\nG0 X0 Y0 Z60\nG1 Z30. F2000\n".to_owned();
    for row in 0..500 {
        for k in 0..2000 {
            let x = 0.15 * f64::from(if row % 2 == 0 { k } else { 1999 - k });
            let y = 0.4 * f64::from(row);
            let sin = |v: f64| units::math::sin_cos(v).0;
            let z = 20.0 + 6.0 * sin(0.05 * x) * sin(0.06 * y + 1.57) + 1.5 * sin(0.31 * x + 0.2 * y);
            let _ = writeln!(nc, "X{x:.3} Y{y:.3} Z{z:.3}");
        }
    }
    nc.push_str("G0 Z60\nM2\n");
    std::fs::write(&program, nc).expect("writable");
    let report = check(plain(&program), &["--work-offset", "G54=50,40,50"]);
    let page = text(&report.page);
    println!("{} bytes", page.len());
    assert!(page.len() < 3_000_000, "{} bytes", page.len());
    let bound =
        page.split("lies within ").nth(1).and_then(|rest| rest.split_whitespace().next()).expect("a bound");
    let bound: f64 = bound.parse().expect("a number");
    assert!(bound < 1000.0, "left out within {bound} um of a path of 360 mm");
    let Some(mut browser) = Browser::start_in_space() else { return };
    browser.open(&report.page);
    browser.evaluate(DRAWN);
    browser.was_quiet();
    // The first frame, of fewer places, and all of them.
    let times = browser.evaluate("(() => { const d = document.documentElement.dataset, t = performance.getEntriesByType('navigation')[0]; return [Number(d.drawn) - t.loadEventEnd, Number(d.whole) - t.loadEventEnd]; })()");
    let [drawn, whole] = [0, 1].map(|k| times[k].as_f64().expect("milliseconds"));
    println!("drawn {drawn:.0} ms after loading, whole {whole:.0} ms");
    assert!(drawn < 1000.0, "drawn {drawn:.0} ms after loading");
    browser.end();
}
