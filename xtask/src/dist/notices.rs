//! The licences of others' code in the binary: most ask that their text goes with it.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;
use std::path::Path;
use std::process::Command;

use anyhow::Context;
use serde_json::Value;

/// The page: which crates, under what, and the texts, each once.
pub(super) fn page(triple: &str) -> anyhow::Result<String> {
    let text = crate::house::text_of(Command::new("cargo").args([
        "metadata",
        "--locked",
        "--format-version",
        "1",
        "--filter-platform",
        triple,
    ]))?;
    let metadata: Value = serde_json::from_str(&text)?;
    let linked = linked(&metadata)?;
    let mut page = String::from(
        "# Others' work in vpost\n\nvpost is linked with these, and with Rust's standard library (MIT OR Apache-2.0, the Rust Project)",
    );
    if triple.contains("musl") {
        page += " and musl (MIT, Copyright © 2005-2020 Rich Felker and others)";
    }
    page += ".\n\n| crate | version | licence |\n|---|---|---|\n";
    let mut texts: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for package in &linked {
        let (name, version) = (text_at(package, "name")?, text_at(package, "version")?);
        let licence = text_at(package, "license").unwrap_or("see below");
        writeln!(page, "| {name} | {version} | {licence} |")?;
        let manifest = Path::new(text_at(package, "manifest_path")?);
        for text in licences(manifest.parent().context("a manifest in a folder")?)? {
            texts.entry(text).or_default().push(format!("{name} {version}"));
        }
    }
    let mut texts: Vec<(String, Vec<String>)> = texts.into_iter().collect();
    texts.sort_by(|a, b| a.1.cmp(&b.1).then(a.0.cmp(&b.0)));
    for (text, of) in texts {
        write!(page, "\n## {}\n\n~~~text\n{text}\n~~~\n", of.join(", "))?;
    }
    Ok(page)
}

/// Others' packages that end up in the binary, by name: neither tools of the build nor of the tests.
fn linked(metadata: &Value) -> anyhow::Result<Vec<&Value>> {
    let all = |list: &'static str| metadata.pointer(list).and_then(Value::as_array).context(list);
    let packages: BTreeMap<&str, &Value> =
        all("/packages")?.iter().filter_map(|package| Some((package["id"].as_str()?, package))).collect();
    let nodes: BTreeMap<&str, &Value> =
        all("/resolve/nodes")?.iter().filter_map(|node| Some((node["id"].as_str()?, node))).collect();
    let root = packages.iter().find(|(_, package)| package["name"] == "vpost").context("no vpost")?.0;
    let mut found = BTreeSet::new();
    let mut left = vec![*root];
    while let Some(id) = left.pop() {
        let is_macro = packages[id]["targets"].as_array().into_iter().flatten().any(|target| {
            target["kind"].as_array().is_some_and(|kinds| kinds.iter().any(|kind| kind == "proc-macro"))
        });
        if is_macro || !found.insert(id) {
            continue;
        }
        for dependency in nodes[id]["deps"].as_array().into_iter().flatten() {
            let kinds = dependency["dep_kinds"].as_array().into_iter().flatten();
            if kinds.into_iter().any(|kind| kind["kind"].is_null()) {
                left.extend(dependency["pkg"].as_str());
            }
        }
    }
    let mut linked: Vec<&Value> =
        found.into_iter().map(|id| packages[id]).filter(|package| !package["source"].is_null()).collect();
    linked.sort_by_key(|package| (package["name"].as_str(), package["version"].as_str()));
    Ok(linked)
}

fn text_at<'v>(package: &'v Value, key: &str) -> anyhow::Result<&'v str> {
    package[key].as_str().with_context(|| format!("a package without {key}"))
}

/// The licence texts in a package's folder, in order of their files.
fn licences(folder: &Path) -> anyhow::Result<Vec<String>> {
    let mut files = Vec::new();
    for entry in std::fs::read_dir(folder)? {
        let path = entry?.path();
        let name = path.file_name().map(|name| name.to_string_lossy().to_uppercase()).unwrap_or_default();
        let is_licence = ["LICENSE", "LICENCE", "COPYING", "COPYRIGHT", "NOTICE", "UNLICENSE"]
            .iter()
            .any(|beginning| name.starts_with(beginning));
        if is_licence && path.is_file() {
            files.push(path);
        }
    }
    files.sort();
    files
        .iter()
        .map(|file| {
            let text =
                std::fs::read_to_string(file).with_context(|| format!("{}: unreadable", file.display()))?;
            // Line ends and blanks at them differ between copies of one text.
            Ok(text.trim().lines().map(str::trim_end).collect::<Vec<_>>().join("\n"))
        })
        .collect()
}
