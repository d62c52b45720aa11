//! `vpost lsp`: conversations over standard input and output, as an editor leads them.
//!
//! Each file of `tests/conversations` is one: `>` a message to the server, `!` bytes as they are, `<` the next
//! message from it (what it has to hold: other keys may stand beside), `$` its exit status. `$ROOT` is the project's
//! folder.

use std::collections::BTreeSet;
use std::ffi::OsString;
use std::io::{BufRead, BufReader, Read, Write};
use std::path::Path;
use std::process::{Child, ChildStdin, ChildStdout, Stdio};

use jobs::options::JobOptions;
use serde_json::{Value, json};

use crate::common::{Place, files, root, vpost};
use crate::docs::{fences, read};

/// A server under test.
struct Server {
    child: Child,
    to: Option<ChildStdin>,
    from: BufReader<ChildStdout>,
}

impl Drop for Server {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

impl Server {
    fn new() -> Self {
        let mut child = vpost()
            .arg("lsp")
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .expect("the command starts");
        let from = BufReader::new(child.stdout.take().expect("a pipe"));
        Self { to: child.stdin.take(), from, child }
    }

    /// One that is initialized with settings.
    fn with(settings: &Value) -> Self {
        let mut server = Self::new();
        let params = json!({ "capabilities": {}, "initializationOptions": settings });
        server.ask(0, "initialize", &params);
        server.tell("initialized", &json!({}));
        server
    }

    fn bytes(&mut self, bytes: &[u8]) {
        let to = self.to.as_mut().expect("it is not ended yet");
        to.write_all(bytes).and_then(|()| to.flush()).expect("the server reads");
    }

    fn send(&mut self, mut message: Value) {
        message["jsonrpc"] = json!("2.0");
        let text = message.to_string();
        self.bytes(format!("Content-Length: {}\r\n\r\n{text}", text.len()).as_bytes());
    }

    fn tell(&mut self, method: &str, params: &Value) {
        self.send(json!({ "method": method, "params": params }));
    }

    fn next(&mut self) -> Value {
        let mut length = 0;
        loop {
            let mut line = String::new();
            assert!(self.from.read_line(&mut line).expect("readable") > 0, "the server has ended");
            match line.trim().split_once(": ") {
                Some((_, number)) => length = number.parse().expect("a length"),
                None => break,
            }
        }
        let mut text = vec![0; length];
        self.from.read_exact(&mut text).expect("a whole message");
        serde_json::from_slice(&text).expect("JSON")
    }

    /// The answer to a request; what is said before it is passed over.
    fn ask(&mut self, id: u32, method: &str, params: &Value) -> Value {
        self.send(json!({ "id": id, "method": method, "params": params }));
        self.answer(id)
    }

    fn answer(&mut self, id: u32) -> Value {
        loop {
            let message = self.next();
            if message["id"] == json!(id) {
                return message;
            }
        }
    }

    fn open(&mut self, text: &str) {
        let document = json!({ "uri": PART, "languageId": "nc", "version": 1, "text": text });
        self.tell("textDocument/didOpen", &json!({ "textDocument": document }));
    }

    /// Puts a text in at the start of a line; the version is then that.
    fn put(&mut self, version: u32, line: u32, text: &str) {
        let place = json!({ "line": line, "character": 0 });
        let change = json!({ "range": { "start": place, "end": place }, "text": text });
        let document = json!({ "uri": PART, "version": version });
        self.tell("textDocument/didChange", &json!({ "textDocument": document, "contentChanges": [change] }));
    }

    /// The numbers of what is said next.
    fn codes(&mut self) -> Vec<String> {
        let said = self.next();
        let all = said["params"]["diagnostics"].as_array().unwrap_or_else(|| panic!("{said}"));
        all.iter().map(|one| one["code"].as_str().expect("a number").to_owned()).collect()
    }

    fn status(&mut self) -> Option<i32> {
        self.to = None;
        self.child.wait().expect("it ends").code()
    }
}

const PART: &str = "file:///nc/part.nc";

fn stan() -> Value {
    json!({ "machine": "machine-profiles/stan_s500.toml", "dialect": "fanuc" })
}

/// A program of about a megabyte in lines, as CAM writes them.
fn megabyte() -> String {
    let mut text = String::from("G21 G17 G90 G94 G54\nG0 X10. Y10. Z30.\nG1 Z15. F600.\n");
    for k in 0..40_000 {
        let [x, y, z] = [(113 * k) % 200_000, (57 * k) % 150_000, (11 * k) % 5_000].map(f64::from);
        let line = format!("X{:.3} Y{:.3} Z{:.3}\n", 10.0 + x / 1e3, 10.0 + y / 1e3, 15.0 + z / 1e3);
        text.push_str(&line);
    }
    text + "M30\n"
}

/// What is asked for stands in what came; `None` where it does, else where not.
fn lacks(wanted: &Value, found: &Value) -> Option<String> {
    match (wanted, found) {
        (Value::Object(wanted), Value::Object(found)) => wanted.iter().find_map(|(key, wanted)| {
            lacks(wanted, found.get(key).unwrap_or(&Value::Null)).map(|what| format!("{key}: {what}"))
        }),
        (Value::Array(wanted), Value::Array(found)) if wanted.len() == found.len() => {
            wanted.iter().zip(found).find_map(|(wanted, found)| lacks(wanted, found))
        }
        _ if wanted == found => None,
        _ => Some(format!("not {wanted} but {found}")),
    }
}

fn converse(path: &Path) -> Result<(), String> {
    let root = root().display().to_string();
    let text = std::fs::read_to_string(path).expect("readable");
    let mut server = Server::new();
    for (line, number) in text.lines().zip(1..) {
        let Some((kind, rest)) = line.split_once(' ') else { continue };
        let rest = rest.replace("$ROOT", &root);
        let json = || serde_json::from_str::<Value>(&rest).unwrap_or_else(|why| panic!("{number}: {why}"));
        match kind {
            ">" => server.send(json()),
            "!" => server.bytes(json().as_str().expect("a text").as_bytes()),
            "<" => {
                let found = server.next();
                if let Some(what) = lacks(&json(), &found) {
                    return Err(format!("{}:{number}: {what}\n{found}", path.display()));
                }
            }
            "$" if server.status().map(|status| status.to_string()) != Some(rest) => {
                return Err(format!("{}:{number}: another exit status", path.display()));
            }
            _ => {}
        }
    }
    // Nothing was said that nobody asked for.
    if server.to.is_some() {
        server.send(json!({ "id": "end", "method": "shutdown" }));
        let last = server.next();
        if last["id"] != json!("end") {
            return Err(format!("{}: at its end {last}", path.display()));
        }
    }
    Ok(())
}

#[test]
fn conversations() {
    let all = files(&root().join("tests/conversations"), &["txt"]);
    assert!(all.len() >= 40, "{}", all.len());
    let wrong: Vec<String> = all.iter().filter_map(|path| converse(path).err()).collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Every message that a program of `docs/diagnostics.md` causes is seen in a conversation, in its place, in both
/// languages.
#[test]
fn every_message_of_a_program() {
    let (mut seen, mut unread, mut wrong) = (BTreeSet::new(), Vec::new(), Vec::new());
    for fence in fences(&read("docs/diagnostics.md")).iter().filter(|fence| fence.language() == "nc") {
        let Some(code) = fence.heading.strip_prefix("VP").map(|title| format!("VP{}", &title[..4])) else {
            continue;
        };
        let words = format!("-d {}", fence.option());
        let Ok(mut options) = JobOptions::read(words.split_whitespace().map(OsString::from)) else {
            unread.push(code);
            continue;
        };
        options.machine.get_or_insert_with(|| "machine-profiles/stan_s500.toml".into());
        let mut settings = serde_json::to_value(&options).expect("a manifest has them so");
        for language in ["en", "ru"] {
            settings["language"] = json!(language);
            let mut server = Server::with(&settings);
            server.open(&fence.text);
            let said = server.next();
            let all = said["params"]["diagnostics"].as_array().unwrap_or_else(|| panic!("{said}"));
            let Some(one) = all.iter().find(|one| one["code"] == json!(code)) else {
                wrong.push(format!("docs/diagnostics.md:{}: no {code} but {said}", fence.line));
                continue;
            };
            let russian = one["message"].as_str().expect("a text").chars().any(|c| matches!(c, 'а'..='я'));
            if russian != (language == "ru") {
                wrong.push(format!("{code} in {language}: {one}"));
            }
            seen.insert(code.clone());
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert_eq!(unread, ["VP0002"], "an option that cannot be understood");
    assert!(seen.len() > 90, "{}", seen.len());
}

/// Ten thousand edits of a program and as many of its answers: the server is no larger at the end than after a
/// thousand.
#[cfg(target_os = "linux")]
#[test]
fn ten_thousand_edits_leave_nothing_behind() {
    let mut server = Server::with(&stan());
    server.open("G21 G17 G90 G94 G54\nG0 X10. Y10. Z30.\nG1 Z15. F500.\nX60.\nM30\n");
    server.next();
    let resident = |server: &Server| -> u64 {
        let status = std::fs::read_to_string(format!("/proc/{}/status", server.child.id())).expect("it runs");
        let line = status.lines().find(|line| line.starts_with("VmRSS")).expect("a line");
        line.split_whitespace().nth(1).and_then(|kilobytes| kilobytes.parse().ok()).expect("a number")
    };
    let mut early = 0;
    for version in 2..10_002 {
        // A word comes and goes; half of the texts are refused.
        let text = if version % 2 == 0 { "G12.9\n" } else { "" };
        let end = json!({ "line": if version % 2 == 0 { 2 } else { 3 }, "character": 0 });
        let range = json!({ "start": { "line": 2, "character": 0 }, "end": end });
        server.tell(
            "textDocument/didChange",
            &json!({
                "textDocument": { "uri": PART, "version": version },
                "contentChanges": [{ "range": range, "text": text }],
            }),
        );
        let refused = server.codes() == ["VP0207"];
        assert_eq!(refused, version % 2 == 0, "{version}");
        if version == 1_000 {
            early = resident(&server);
        }
    }
    let late = resident(&server);
    assert!(late < early + early / 10, "{early} KiB, then {late} KiB");
}

/// A megabyte is checked as it is typed, and what is typed meanwhile ends the check: of many edits the last alone is
/// sure to be answered.
#[test]
fn edits_overtake_the_check() {
    const EDITS: u32 = 200;
    let mut server = Server::with(&stan());
    server.open(&megabyte());
    server.next();
    for version in 2..=EDITS {
        server.put(version, 20_000, if version == EDITS { "G12.9\n" } else { " " });
    }
    let (mut answers, mut last) = (0, Value::Null);
    while last["params"]["version"] != json!(EDITS) {
        last = server.next();
        answers += 1;
    }
    assert!(answers < EDITS / 2, "{answers} answers");
    let one = &last["params"]["diagnostics"][0];
    assert_eq!((&one["code"], &one["range"]["start"]["line"]), (&json!("VP0207"), &json!(20_000)));
}

/// A request that takes its time can be taken back.
#[test]
fn a_request_is_cancelled() {
    let mut server = Server::with(&stan());
    server.open(&megabyte());
    server.next();
    let at = json!({ "textDocument": { "uri": PART }, "position": { "line": 40_000, "character": 0 } });
    server.send(json!({ "id": 1, "method": "textDocument/hover", "params": at }));
    server.send(json!({ "id": 2, "method": "textDocument/hover", "params": at }));
    server.tell("$/cancelRequest", &json!({ "id": 2 }));
    assert!(server.answer(1)["result"]["contents"]["value"].is_string());
    assert_eq!(server.answer(2)["error"]["code"], json!(-32800));
}

/// What is too large is said and not read, and the conversation goes on.
#[test]
fn what_is_too_large_is_said() {
    let mut server = Server::with(&stan());
    server.bytes(b"Content-Length: 524288000\r\n\r\n");
    let megabyte = vec![b' '; 1 << 20];
    (0..500).for_each(|_| server.bytes(&megabyte));
    let said = server.next();
    assert_eq!(said["method"], json!("window/showMessage"));
    assert!(said["params"]["message"].as_str().expect("a text").contains("500 MB"), "{said}");
    server.open(&"G0 X1.\n".repeat(3 << 20));
    assert_eq!(server.codes(), ["VP0009"]);
    server.put(2, 0, "(A)\n");
    assert_eq!(server.codes(), ["VP0009"]);
}

/// An end within a message is said before the server goes.
#[test]
fn a_message_that_is_cut_off_is_said() {
    for cut in ["Content-Length: 50\r\n\r\n{\"jsonrpc\"", "Content-Length: 50\r\n"] {
        let mut server = Server::with(&stan());
        server.bytes(cut.as_bytes());
        server.to = None;
        let said = server.next();
        assert_eq!(said["error"]["code"], json!(-32700), "{said}");
    }
}

/// A profile that is mended and saved holds at once.
#[test]
fn a_profile_is_read_again() {
    let place = Place::new();
    let axes = ["X", "Y", "Z"].map(|axis| format!("axis.{axis} = {{ travel_mm = [0, 500] }}\n")).concat();
    let head = "format = 1\nname = \"Square\"\ncontrol = \"fanuc\"\nchain = \"[w X Y b Z t]\"\n";
    let rest = "work_offsets_mm = { G54 = [0, 0, 0] }\nsquareness = { EC0Y_urad = 60 }\n";
    let profile = &format!("{head}{axes}{rest}");
    let path = place.write("machine.toml", &profile.replace("[0, 0, 0]", "[0, 0]"));
    let mut server = Server::with(&json!({ "machine": path }));
    server.open("G21 G17 G90 G54\nG0 X10. Y10. Z30.\nM30\n");
    assert_eq!(server.codes(), ["VP0303"]);
    place.write("machine.toml", profile);
    server.tell("textDocument/didSave", &json!({ "textDocument": { "uri": PART } }));
    assert_eq!(server.codes(), Vec::<String>::new());
}
