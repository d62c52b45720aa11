//! The command as one file for a browser: `vpost.html`.
//!
//! The whole command, compiled for WASI preview 1, runs in a worker on files in memory (`machine.js`); the page
//! (`page.js`) drops files into it, makes its form of `vpost man --json`, and shows what came out. So the page does what
//! the command does, byte for byte, and holds no second description of it. It asks nothing of a network: its policy
//! allows its own script, the viewer's, and a worker of its own text.

use std::collections::BTreeMap;
use std::io::Write;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use flate2::{Compression, write::GzEncoder};

/// Around the parts.
const PAGE: &str = include_str!("page.html");
/// What runs in the page.
const SCRIPT: &str = concat!(include_str!("words.js"), include_str!("page.js"));
/// What runs beside it.
const WORKER: &str = concat!(include_str!("machine.js"), include_str!("worker.js"));
/// Behind the styles of every page.
const STYLE: &str = include_str!("page.css");

/// The page.
///
/// * `command` – `vpost` as a module of WebAssembly
/// * `example` – files to try it with, by their names: a program, a profile, its tables
///
/// # Errors
/// None that memory can give; packing has them.
pub fn assembled(command: &[u8], example: &BTreeMap<String, String>) -> std::io::Result<String> {
    let mut packed = GzEncoder::new(Vec::new(), Compression::best());
    packed.write_all(command)?;
    let command = STANDARD.encode(packed.finish()?);
    // No text may end its element.
    let example = serde_json::to_string(example)?.replace("</", "<\\/");
    let style = format!("{}{STYLE}", report::STYLE);
    let policy = policy();
    let parts = [
        ("policy", policy.as_str()),
        ("style", &style),
        ("example", &example),
        ("worker", WORKER),
        ("command", &command),
        ("script", SCRIPT),
    ];
    let mut page = String::with_capacity(command.len() + (1 << 20));
    let mut rest = PAGE;
    while let Some((before, (name, after))) =
        rest.split_once("{{").and_then(|(before, after)| Some((before, after.split_once("}}")?)))
    {
        page.push_str(before);
        page.push_str(parts.iter().find(|(known, _)| *known == name).map_or("", |(_, text)| text));
        rest = after;
    }
    page.push_str(rest);
    Ok(page)
}

/// What the page may do. Reports that are looked at inside it bring their styles and, of scripts, the viewer's alone.
fn policy() -> String {
    let [own, viewer] = [SCRIPT, report::viewer::SCRIPT].map(report::viewer::source);
    format!(
        "default-src 'none'; script-src {own} {viewer} 'wasm-unsafe-eval'; worker-src blob:; style-src 'unsafe-inline'; img-src data:; base-uri 'none'; form-action 'none'"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_page_is_one_file_with_every_part_in_it() {
        let example = BTreeMap::from([("part.nc".to_owned(), "G0 X1 (</script>)\n".to_owned())]);
        let page = assembled(b"\0asm", &example).unwrap();
        assert!(!page.contains("{{"), "a part is missing");
        assert_eq!(page.matches("<script").count(), page.matches("</script>").count());
        assert_eq!(page.matches("</script>").count(), 4);
        for address in ["http:", "https:", "src=\"", "@import", "url("] {
            let own = page.replace("http://www.w3.org/2000/svg", "");
            assert!(!own.contains(address), "the page names {address}");
        }
        assert_eq!(page, assembled(b"\0asm", &example).unwrap());
    }

    #[test]
    fn both_languages_have_every_word() {
        let words = include_str!("words.js");
        let (english, russian) = words.split_once("\n  ru: {").unwrap();
        let keys = |text: &str| {
            let mut keys: Vec<String> = text
                .lines()
                .filter_map(|line| Some(line.strip_prefix("    ")?.split_once(": ")?.0.to_owned()))
                .filter(|key| !key.starts_with(' '))
                .collect();
            keys.sort();
            keys.dedup();
            keys
        };
        assert_eq!(keys(english), keys(russian));
        assert!(keys(english).len() > 60);
        let page = PAGE.to_owned() + include_str!("page.js");
        for key in keys(english) {
            let quoted = [format!(".{key}"), format!("\"{key}\"")];
            assert!(quoted.iter().any(|spelt| page.contains(spelt)), "`{key}` is used nowhere");
        }
    }
}
