//! The limits of the house: `docs/house.toml` holds them, `docs/house.md` shows them.
//!
//! A limit only falls by itself. To raise one is a step of its own with a sentence why.

use std::fmt::Write as _;
use std::path::Path;

use anyhow::{Context, bail};
use serde::{Deserialize, Serialize};

use crate::markdown::table;

const LEDGER: &str = "docs/house.toml";
const PAGE: &str = "docs/house.md";

/// All limits.
#[derive(Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
struct Ledger {
    figure: Vec<Limited>,
}

/// A figure and what it may be.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
struct Limited {
    key: String,
    /// What is counted.
    counts: String,
    /// What it was when the ledger began.
    began: usize,
    limit: usize,
    /// Each time that the limit rose.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    raised: Vec<Raised>,
}

#[derive(Debug, Clone, PartialEq, Eq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
struct Raised {
    to: usize,
    why: String,
}

/// A figure by the name that the ledger has for it; none where it cannot be measured here.
pub(crate) type Measured = (&'static str, Option<usize>);

impl Ledger {
    fn read(root: &Path) -> anyhow::Result<Self> {
        let text =
            std::fs::read_to_string(root.join(LEDGER)).with_context(|| format!("{LEDGER}: unreadable"))?;
        toml::from_str(&text).with_context(|| format!("{LEDGER}: not a ledger"))
    }

    /// What does not hold; empty where all does.
    fn complaints(&self, measured: &[Measured]) -> Vec<String> {
        let mut wrong = Vec::new();
        for limited in &self.figure {
            let Limited { key, began, limit, raised, .. } = limited;
            match measured.iter().find(|(name, _)| name == key) {
                None => wrong.push(format!("`{key}` is in {LEDGER} and nothing measures it: take it out")),
                Some((_, Some(now))) if now > limit => wrong.push(format!(
                    "`{key}` is {now}, allowed are {limit}: take as much back in the same change, or say why by \
                     cargo xtask house --raise '{key}=One sentence.'"
                )),
                Some(_) => {}
            }
            if raised.iter().any(|step| step.why.split_whitespace().count() < 3) {
                wrong.push(format!("`{key}` was raised without a sentence: {LEDGER} wants it in `why`"));
            }
            if raised.iter().map(|step| step.to).fold(*began, usize::max) < *limit {
                wrong.push(format!(
                    "`{key}` has the limit {limit}, above all that was argued for: use cargo xtask house --raise"
                ));
            }
        }
        for (key, _) in measured {
            if self.figure.iter().all(|limited| limited.key != *key) {
                wrong.push(format!(
                    "`{key}` has no limit: put it back into {LEDGER} and run cargo xtask house --write"
                ));
            }
        }
        wrong
    }

    /// Limits go down to what was measured; a raised one goes up to it.
    fn turned(mut self, measured: &[Measured], raise: &[(String, String)]) -> anyhow::Result<Self> {
        if let Some((key, _)) = raise.iter().find(|(key, _)| self.figure.iter().all(|own| own.key != *key)) {
            let known: Vec<&str> = self.figure.iter().map(|own| own.key.as_str()).collect();
            bail!("no figure is called `{key}`: one of {}", known.join(", "));
        }
        for limited in &mut self.figure {
            let now =
                measured.iter().find(|(name, _)| *name == limited.key).and_then(|(_, now)| now.as_ref());
            let Some(now) = now else { continue };
            limited.limit = match raise.iter().find(|(key, _)| *key == limited.key) {
                Some((_, why)) if *now > limited.limit => {
                    limited.raised.push(Raised { to: *now, why: why.clone() });
                    *now
                }
                _ => limited.limit.min(*now),
            };
        }
        Ok(self)
    }

    fn page(&self) -> String {
        let rows: Vec<Vec<String>> = self
            .figure
            .iter()
            .map(|own| vec![format!("`{}`", own.key), own.limit.to_string(), own.counts.clone()])
            .collect();
        let mut text = INTRODUCTION.to_owned() + &table(&["figure", "at most", "what it counts"], &rows);
        text += "\n## What rose, and why\n\n";
        for own in &self.figure {
            for Raised { to, why } in &own.raised {
                let _ = writeln!(text, "- `{}` to {to}: {why}", own.key);
            }
        }
        if self.figure.iter().all(|own| own.raised.is_empty()) {
            text += "Nothing yet.\n";
        }
        crate::wrap::wrapped(&text)
    }
}

const INTRODUCTION: &str = "# The house, measured

How large the code is, what in it is too long, and which files go in circles. This page is made from `docs/house.toml`;
`.ci/run` fails where a figure is above its limit, has none, or where this page is not what the limits make.

| to | type |
|---|---|
| see today's figures | `cargo xtask house` |
| see what stands behind each | `cargo xtask house --list` |
| hold them against the limits | `cargo xtask house --check` |
| turn limits down to what is, and make this page | `cargo xtask house --write` |
| let one rise | `cargo xtask house --raise 'lines_of_code=One sentence why.'` |
| time a clone until its tests are green | `cargo xtask house --time` |

Measured are the Rust files that git knows or would take, read by `syn`. Code is what is neither a test nor below
`tests`, `benches` or `examples`. A file imports another when a path in it ends in an item that stands there; names that
a `pub use` hands on are followed to where they stand. What only a macro imports is not seen. Of scripts, styles and
judges lines are counted, whatever else stands on them.

";

/// Holds the figures against their limits.
///
/// # Errors
/// A figure above its limit, one without a limit, a page that is stale: each with the command that mends it.
pub(crate) fn check(root: &Path, measured: &[Measured]) -> anyhow::Result<String> {
    let ledger = Ledger::read(root)?;
    let mut wrong = ledger.complaints(measured);
    if std::fs::read_to_string(root.join(PAGE)).ok().as_deref() != Some(&ledger.page()) {
        wrong.push(format!("{PAGE} is stale: run cargo xtask house --write"));
    }
    if !wrong.is_empty() {
        bail!("the house\n- {}", wrong.join("\n- "));
    }
    let lower = ledger.figure.iter().filter(|own| {
        measured.iter().any(|(key, now)| *key == own.key && now.is_some_and(|now| now < own.limit))
    });
    let lower: Vec<&str> = lower.map(|own| own.key.as_str()).collect();
    Ok(match lower.as_slice() {
        [] => "the house is as its limits say\n".to_owned(),
        some => {
            format!("below their limits, cargo xtask house --write turns them down: {}\n", some.join(", "))
        }
    })
}

/// Turns limits down, raises those that a sentence stands for, and makes the page.
///
/// # Errors
/// A figure nobody knows, files that cannot be written.
pub(crate) fn write(
    root: &Path,
    measured: &[Measured],
    raise: &[(String, String)],
) -> anyhow::Result<String> {
    let ledger = Ledger::read(root)?.turned(measured, raise)?;
    std::fs::write(root.join(LEDGER), toml::to_string_pretty(&ledger)?)?;
    std::fs::write(root.join(PAGE), ledger.page())?;
    check(root, measured)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ledger(limit: usize, raised: &[(usize, &str)]) -> Ledger {
        let raised = raised.iter().map(|(to, why)| Raised { to: *to, why: (*why).to_owned() }).collect();
        let (key, counts) = ("circles".to_owned(), String::new());
        Ledger { figure: vec![Limited { key, counts, began: 9, limit, raised }] }
    }

    #[test]
    fn what_rises_is_refused_and_says_what_to_type() {
        let wrong = ledger(4, &[]).complaints(&[("circles", Some(5))]);
        assert_eq!(wrong.len(), 1);
        assert!(wrong[0].contains("--raise 'circles="), "{wrong:?}");
        assert!(ledger(4, &[]).complaints(&[("circles", Some(3))]).is_empty());
    }

    #[test]
    fn a_limit_is_not_raised_by_hand() {
        assert_eq!(ledger(12, &[(10, "two rooms were parted")]).complaints(&[("circles", Some(8))]).len(), 1);
        assert_eq!(ledger(7, &[(7, "")]).complaints(&[("circles", Some(7))]).len(), 1);
        assert_eq!(ledger(7, &[]).complaints(&[("files", Some(7))]).len(), 2);
    }

    #[test]
    fn limits_fall_by_themselves_and_rise_by_a_sentence() {
        let fallen = ledger(9, &[]).turned(&[("circles", Some(5))], &[]).expect("known");
        assert_eq!(fallen.figure[0].limit, 5);
        let why = [("circles".to_owned(), "one is worth it".to_owned())];
        let raised = fallen.turned(&[("circles", Some(6))], &why).expect("known");
        assert_eq!((raised.figure[0].limit, raised.figure[0].raised.len()), (6, 1));
        assert!(raised.complaints(&[("circles", Some(6))]).is_empty());
        let unknown = [("squares".to_owned(), "one is worth it".to_owned())];
        assert!(ledger(1, &[]).turned(&[("circles", Some(1))], &unknown).is_err());
    }
}
