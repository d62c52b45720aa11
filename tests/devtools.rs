//! Chromium by its own protocol over a pipe: started once for all pages of a test.
//!
//! A start costs more than most pages do. What a page says and asks for is told while it is open; what the whole browser
//! asked of the network stands in its log, which is read when it has ended.

use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Child, ChildStdin, Command, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::time::Duration;

use serde_json::{Value, json};

/// No window, no errands of its own.
const OPTIONS: [&str; 11] = [
    "--headless",
    "--no-sandbox",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--disable-default-apps",
    "--disable-extensions",
    "--hide-scrollbars",
    "--remote-debugging-pipe",
];

/// Pages are put together by the processor, what is drawn in space too: the quickest. The browser then says in the console
/// that it fetches each picture from there.
const FLAT: [&str; 2] = ["--disable-gpu", "--enable-unsafe-swiftshader"];
/// As on a computer with a graphics card, but by the processor.
const SPACE: [&str; 3] = ["--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"];

/// Whoever does not answer within this has hung.
const PATIENCE: Duration = Duration::from_secs(300);

/// How a page is looked at.
#[derive(Clone, Copy)]
pub(crate) struct View {
    pub(crate) width: u32,
    pub(crate) height: u32,
    pub(crate) is_dark: bool,
    pub(crate) is_paper: bool,
    /// The reader wants nothing to move by itself.
    pub(crate) is_calm: bool,
}

impl View {
    pub(crate) const DESK: Self =
        Self { width: 1400, height: 1000, is_dark: false, is_paper: false, is_calm: false };
    pub(crate) const DARK: Self = Self { is_dark: true, ..Self::DESK };
    pub(crate) const PHONE: Self = Self { width: 390, height: 844, ..Self::DESK };
    pub(crate) const DARK_PHONE: Self = Self { is_dark: true, ..Self::PHONE };
    /// A4 less its margins.
    pub(crate) const PAPER: Self = Self { width: 680, is_paper: true, ..Self::DESK };
}

/// A browser with an empty profile and one page.
pub(crate) struct Browser {
    process: Child,
    to: ChildStdin,
    answers: Receiver<Value>,
    session: Option<String>,
    asked: u64,
    /// Since the page was opened.
    events: Vec<Value>,
    page: String,
    view: View,
    folder: tempfile::TempDir,
}

impl Browser {
    /// `None` where there is no browser, which is said; with `CI` set there must be one.
    pub(crate) fn start() -> Option<Self> {
        Self::start_with(&FLAT)
    }

    /// For pages in space whose console is read.
    pub(crate) fn start_in_space() -> Option<Self> {
        Self::start_with(&SPACE)
    }

    /// One that cannot draw in space.
    pub(crate) fn start_without_space() -> Option<Self> {
        Self::start_with(&["--disable-gpu", "--disable-3d-apis"])
    }

    /// * `more` – options of the command line
    fn start_with(more: &[&str]) -> Option<Self> {
        let there = Command::new("chromium")
            .arg("--version")
            .stderr(Stdio::null())
            .output()
            .is_ok_and(|output| output.status.success());
        assert!(there || std::env::var_os("CI").is_none(), "chromium must be installed where CI is set");
        if !there {
            skipped();
            return None;
        }
        let folder = tempfile::tempdir().expect("a temporary folder");
        // Questions come by file 3, answers go by file 4.
        let mut process = Command::new("sh")
            .args(["-c", "exec \"$@\" 3<&0 4>&1 </dev/null >/dev/null 2>&1", "sh", "chromium"])
            .args(OPTIONS)
            .args(more)
            .arg(format!("--user-data-dir={}", folder.path().join("profile").display()))
            .arg(format!("--log-net-log={}", folder.path().join("net.json").display()))
            // Else it asks for its start page.
            .arg("about:blank")
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .expect("the browser starts");
        let to = process.stdin.take().expect("a pipe");
        let from = BufReader::new(process.stdout.take().expect("a pipe"));
        let (send, answers) = channel();
        std::thread::spawn(move || {
            for message in from.split(0).map_while(Result::ok) {
                let message = serde_json::from_slice(&message).expect("the browser speaks JSON");
                if send.send(message).is_err() {
                    return;
                }
            }
        });
        let (session, asked, events, page, view) = (None, 0, Vec::new(), String::new(), View::DESK);
        let mut browser = Self { process, to, answers, session, asked, events, page, view, folder };
        let target = browser.ask("Target.createTarget", &json!({ "url": "about:blank" }));
        let attached = json!({ "targetId": target["targetId"], "flatten": true });
        let session = browser.ask("Target.attachToTarget", &attached);
        browser.session = session["sessionId"].as_str().map(str::to_owned);
        for part in ["Page", "Runtime", "Log", "Network"] {
            browser.ask(&format!("{part}.enable"), &json!({}));
        }
        browser.look(view);
        Some(browser)
    }

    fn receive(&self) -> Value {
        self.answers.recv_timeout(PATIENCE).expect("the browser answers")
    }

    fn ask(&mut self, method: &str, parameters: &Value) -> Value {
        self.asked += 1;
        let mut question = json!({ "id": self.asked, "method": method, "params": parameters });
        if let Some(session) = &self.session {
            question["sessionId"] = json!(session);
        }
        let mut bytes = question.to_string().into_bytes();
        bytes.push(0);
        self.to.write_all(&bytes).expect("the browser listens");
        loop {
            let mut answer = self.receive();
            if answer["id"] == json!(self.asked) {
                assert!(answer.get("error").is_none(), "{method}: {answer}");
                return answer["result"].take();
            }
            self.events.push(answer);
        }
    }

    /// From now on pages are looked at in this way.
    pub(crate) fn look(&mut self, view: View) {
        self.view = view;
        let View { width, height, is_dark, is_paper, is_calm } = view;
        let size = json!({ "width": width, "height": height, "deviceScaleFactor": 1, "mobile": false });
        self.ask("Emulation.setDeviceMetricsOverride", &size);
        let features = json!([
            { "name": "prefers-color-scheme", "value": if is_dark { "dark" } else { "light" } },
            { "name": "prefers-reduced-motion", "value": if is_calm { "reduce" } else { "no-preference" } },
        ]);
        // Named, it would be that of what is printed, too.
        let media = if is_paper { "print" } else { "" };
        self.ask("Emulation.setEmulatedMedia", &json!({ "media": media, "features": features }));
    }

    /// Opens a page, and waits until it is loaded.
    pub(crate) fn open(&mut self, page: &Path) {
        self.events.clear();
        self.page = format!("file://{}", page.display());
        let went = self.ask("Page.navigate", &json!({ "url": self.page }));
        assert!(went.get("errorText").is_none(), "{}: {went}", self.page);
        while !self.events.iter().any(|event| event["method"] == "Page.loadEventFired") {
            let event = self.receive();
            self.events.push(event);
        }
    }

    /// What a script in the page gives; of a promise, what it promises.
    pub(crate) fn evaluate(&mut self, script: &str) -> Value {
        let mut parameters = json!({ "expression": script, "awaitPromise": true });
        parameters["returnByValue"] = json!(true);
        let mut answer = self.ask("Runtime.evaluate", &parameters);
        assert!(answer.get("exceptionDetails").is_none(), "{}: {answer}", self.page);
        answer["result"]["value"].take()
    }

    /// Waits until a script's value is true.
    pub(crate) fn wait(&mut self, script: &str) {
        let waited = format!(
            "new Promise(done => {{
                const look = () => {{ try {{ if ({script}) return done(true); }} catch {{}} setTimeout(look, 20); }};
                look();
                setTimeout(() => done(false), 120000);
            }})"
        );
        assert_eq!(self.evaluate(&waited), json!(true), "{}: never `{script}`", self.page);
    }

    /// Files for an input of the page, as a person chooses them.
    pub(crate) fn choose(&mut self, input: &str, files: &[&Path]) {
        let document = self.ask("DOM.getDocument", &json!({}));
        let asked = json!({ "nodeId": document["root"]["nodeId"], "selector": input });
        let node = self.ask("DOM.querySelector", &asked)["nodeId"].take();
        self.ask("DOM.setFileInputFiles", &json!({ "nodeId": node, "files": files }));
    }

    /// Files and folders from the disk, dragged onto an element and dropped there.
    pub(crate) fn drag(&mut self, onto: &str, files: &[&Path]) {
        let place = self.evaluate(&format!(
            "(() => {{ const place = document.querySelector({onto:?}); place.scrollIntoView(); \
             const box = place.getBoundingClientRect(); return [box.x + 20, box.y + 20]; }})()"
        ));
        let data = json!({ "items": [], "files": files, "dragOperationsMask": 1 });
        for kind in ["dragEnter", "dragOver", "drop"] {
            let event = json!({ "type": kind, "x": place[0], "y": place[1], "data": data });
            self.ask("Input.dispatchDragEvent", &event);
        }
    }

    /// A key of the keyboard: `Tab`, `Enter`, `ArrowDown`, ` `.
    pub(crate) fn press(&mut self, key: &str) {
        let (code, text) = match key {
            "Tab" => (9, ""),
            "Enter" => (13, "\r"),
            " " => (32, " "),
            "ArrowDown" => (40, ""),
            _ => panic!("no such key: {key}"),
        };
        for kind in ["keyDown", "keyUp"] {
            let mut event = json!({ "type": kind, "key": key, "windowsVirtualKeyCode": code });
            if kind == "keyDown" && !text.is_empty() {
                event["text"] = json!(text);
            }
            self.ask("Input.dispatchKeyEvent", &event);
        }
    }

    /// What is typed where the keyboard writes.
    pub(crate) fn write(&mut self, text: &str) {
        self.ask("Input.insertText", &json!({ "text": text }));
    }

    /// The document as it is now.
    pub(crate) fn document(&mut self) -> String {
        let document = self.evaluate("document.documentElement.outerHTML");
        document.as_str().expect("a document").to_owned()
    }

    /// What the open page wrote to the console, and what it asked for besides itself.
    pub(crate) fn said_and_asked(&mut self) -> [Vec<String>; 2] {
        // Whatever has happened has been told before the next answer.
        self.evaluate("0");
        let own = |event: &Value| {
            let url = event["params"]["request"]["url"].as_str().or(event["params"]["url"].as_str());
            url.unwrap_or_default().trim_end_matches('#').to_owned()
        };
        let mut found = [Vec::new(), Vec::new()];
        for event in &self.events {
            match event["method"].as_str().unwrap_or_default() {
                "Runtime.consoleAPICalled" | "Runtime.exceptionThrown" | "Log.entryAdded" => {
                    found[0].push(event["params"].to_string());
                }
                "Network.requestWillBeSent" | "Network.webSocketCreated"
                    if !["data:", "blob:"].iter().any(|inner| own(event).starts_with(inner))
                        && unescaped(&own(event)) != self.page =>
                {
                    found[1].push(own(event));
                }
                _ => {}
            }
        }
        found
    }

    /// The open page has written nothing to the console and asked for nothing.
    pub(crate) fn was_quiet(&mut self) {
        let page = self.page.clone();
        let found = self.said_and_asked();
        assert!(found.iter().all(Vec::is_empty), "{page}: {found:?}");
    }

    /// A picture of what is seen.
    pub(crate) fn picture(&mut self) -> Vec<u8> {
        decoded(&self.captured())
    }

    /// The same in at most 256 colours, a third of its size: for what is kept.
    pub(crate) fn small_picture(&mut self) -> Vec<u8> {
        let picture = self.captured();
        let script = concat!("(", include_str!("few_colours.js"), ")");
        let small = self.evaluate(&format!("{script}('{picture}')"));
        decoded(small.as_str().expect("a picture"))
    }

    /// The whole page, from its top downwards in as few pictures as a browser can make.
    pub(crate) fn whole_picture(&mut self) -> Vec<Vec<u8>> {
        /// Higher ones repeat themselves.
        const HIGHEST: u32 = 8000;
        let seen = self.view;
        let height = self.evaluate("document.documentElement.scrollHeight");
        let height = height.as_u64().and_then(|height| height.try_into().ok()).unwrap_or(seen.height);
        let mut pictures = Vec::new();
        for top in (0..height).step_by(HIGHEST as usize) {
            // A window of that height: a picture beyond the window is taken before drawings have their new size.
            self.look(View { height: (height - top).min(HIGHEST), ..seen });
            self.evaluate(&format!("new Promise(done => {{ scrollTo(0, {top}); setTimeout(done, 200); }})"));
            pictures.push(self.picture());
        }
        self.look(seen);
        pictures
    }

    /// A picture as the browser writes it, base64.
    fn captured(&mut self) -> String {
        let answer = self.ask("Page.captureScreenshot", &json!({ "format": "png" }));
        answer["data"].as_str().expect("a picture").to_owned()
    }

    /// The page on paper, as PDF, with its headings as outline.
    pub(crate) fn printed(&mut self) -> Vec<u8> {
        /// A4, inches.
        const SHEET: [f64; 2] = [210.0 / 25.4, 297.0 / 25.4];
        let mut parameters = json!({ "preferCSSPageSize": true, "generateTaggedPDF": true });
        parameters["generateDocumentOutline"] = json!(true);
        [parameters["paperWidth"], parameters["paperHeight"]] = SHEET.map(|side| json!(side));
        let answer = self.ask("Page.printToPDF", &parameters);
        decoded(answer["data"].as_str().expect("a PDF"))
    }

    /// Ends the browser, which must have asked nothing of the network.
    pub(crate) fn end(self) {
        let asked = self.requests();
        assert!(asked.is_empty(), "{asked:?}");
    }

    /// Ends the browser, and gives the addresses in its log that are of the network.
    pub(crate) fn requests(mut self) -> Vec<String> {
        self.session = None;
        self.ask("Browser.close", &json!({}));
        self.process.wait().expect("the browser ends");
        let log = std::fs::read_to_string(self.folder.path().join("net.json"));
        let log = log.expect("the browser writes its log of requests");
        let mut found: Vec<String> = log
            .split("\"url\":\"")
            .skip(1)
            .filter_map(|part| part.split('"').next())
            // Pages that were opened, and the browser's own errands.
            .filter(|url| {
                !["data:", "blob:", "file:", "about:", "chrome:"].iter().any(|own| url.starts_with(own))
            })
            .filter(|url| {
                !["google.com", "googleapis.com", "gvt1.com", "gstatic.com"]
                    .iter()
                    .any(|own| url.contains(own))
            })
            .map(str::to_owned)
            .collect();
        found.sort();
        found.dedup();
        found
    }
}

#[expect(clippy::print_stdout, reason = "whoever tests is told")]
fn skipped() {
    println!("skipped: chromium is not installed");
}

impl Drop for Browser {
    fn drop(&mut self) {
        // A test that failed has not ended it.
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

/// An address with its per cent signs resolved.
fn unescaped(url: &str) -> String {
    let (mut bytes, mut rest) = (Vec::new(), url.as_bytes());
    while let Some((first, behind)) = rest.split_first() {
        let digits = (*first == b'%').then(|| behind.get(..2)).flatten();
        let code = digits.and_then(|two| u8::from_str_radix(std::str::from_utf8(two).ok()?, 16).ok());
        bytes.push(code.unwrap_or(*first));
        rest = if code.is_some() { &behind[2..] } else { behind };
    }
    String::from_utf8_lossy(&bytes).into_owned()
}

/// RFC 4648.
pub(crate) fn decoded(text: &str) -> Vec<u8> {
    let six = |byte: u8| match byte {
        b'A'..=b'Z' => byte - b'A',
        b'a'..=b'z' => byte - b'a' + 26,
        b'0'..=b'9' => byte - b'0' + 52,
        b'+' => 62,
        _ => 63,
    };
    let mut bytes = Vec::with_capacity(text.len() / 4 * 3);
    for group in text.trim_end_matches('=').as_bytes().chunks(4) {
        let bits = group.iter().fold(0u32, |bits, byte| bits << 6 | u32::from(six(*byte)));
        let bits = bits << (6 * (4 - group.len()));
        bytes.extend(bits.to_be_bytes()[1..group.len()].iter());
    }
    bytes
}

/// Pages of a PDF, and for each heading of its outline the page and how far above its lower edge it stands, points.
pub(crate) fn sheets_and_headings(pdf: &[u8]) -> (usize, Vec<(usize, f64)>) {
    let text = String::from_utf8_lossy(pdf);
    let objects = text.split("\nendobj").filter_map(|object| {
        let (head, body) = object.trim_start().split_once(" obj")?;
        let number: u32 = head.rsplit('\n').next()?.split(' ').next()?.parse().ok()?;
        Some((number, body))
    });
    let mut sheets = Vec::new();
    let mut headings = Vec::new();
    for (number, body) in objects {
        if body.contains("/Type /Page\n") {
            sheets.push(number);
        }
        // `/Dest [7 0 R /XYZ 42 700 0]`
        if let Some(place) = body.split("/Dest [").nth(1) {
            let mut words = place.split([' ', ']']);
            let sheet: Option<u32> = words.next().and_then(|word| word.parse().ok());
            let height: Option<f64> = words.nth(4).and_then(|word| word.parse().ok());
            headings.extend(sheet.zip(height));
        }
    }
    let place = |(sheet, height): (u32, f64)| Some((sheets.iter().position(|own| *own == sheet)?, height));
    (sheets.len(), headings.into_iter().filter_map(place).collect())
}
