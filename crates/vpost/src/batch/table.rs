//! The table at the end.

use std::collections::BTreeMap;

use super::record::{Fault, Record, Status};
use super::work::Results;

/// The results in a few lines: how many, how far off, and what was refused for which reason.
pub(crate) fn table(results: &Results) -> String {
    let records = &results.records;
    let mut text = String::from("            programs      MB in     MB out\n");
    for (status, name) in [
        (Status::Corrected, "corrected"),
        (Status::Unchanged, "unchanged"),
        (Status::Refused, "refused"),
        (Status::Failed, "failed"),
    ] {
        let of = |record: &&Record| record.status == status;
        let count = records.iter().filter(of).count();
        let megabytes =
            |bytes: fn(&Record) -> u64| records.iter().filter(of).map(bytes).sum::<u64>() as f64 / 1e6;
        let into = megabytes(|record| record.bytes_in);
        let out = if status == Status::Corrected || status == Status::Unchanged {
            format!("{:11.3}", megabytes(|record| record.bytes_out.unwrap_or(0)))
        } else {
            String::new()
        };
        if count > 0 || status == Status::Corrected {
            text.push_str(&format!("{name:<12}{count:8}{into:11.3}{out}\n"));
        }
    }
    if results.resumed > 0 {
        text.push_str(&format!("{} of them were done by an earlier run\n", results.resumed));
    }
    let largest = records
        .iter()
        .filter_map(|record| Some((record.figures.as_ref()?, &record.output)))
        .reduce(|a, b| if b.0.largest_correction_um > a.0.largest_correction_um { b } else { a });
    if let Some((figures, output)) = largest {
        text.push_str(&format!(
            "largest correction: {:.1} um ({output}, line {})\n",
            figures.largest_correction_um, figures.largest_correction_line
        ));
    }
    let after = records.iter().filter_map(|record| Some(record.figures.as_ref()?.deviation_after_um));
    let before = records.iter().filter_map(|record| Some(record.figures.as_ref()?.deviation_before_um));
    if let (Some(before), Some(after)) = (before.reduce(f64::max), after.reduce(f64::max)) {
        text.push_str(&format!("paths off by at most {before:.1} um before, {after:.2} um after\n"));
    }
    text.push_str(&reasons("refused or failed", records, |record| &record.errors));
    text.push_str(&reasons("warnings", records, |record| &record.warnings));
    let older: Vec<&str> =
        records.iter().filter(|record| record.older_output).map(|record| record.output.as_str()).collect();
    if let Some(first) = older.first() {
        text.push_str(&format!(
            "{} of these still {} an output of an earlier run, which is out of date: {first}{}\n",
            older.len(),
            if older.len() == 1 { "has" } else { "have" },
            if older.len() == 1 { "" } else { ", …" },
        ));
    }
    text
}

/// Message numbers with how many programs have them and the first of those.
fn reasons<'r>(title: &str, records: &'r [Record], faults: impl Fn(&'r Record) -> &'r Vec<Fault>) -> String {
    let mut by_code: BTreeMap<(&str, &str), (usize, &str, &str)> = BTreeMap::new();
    for record in records {
        let mut codes: Vec<&Fault> = faults(record).iter().collect();
        // The first of each stays: sorting keeps their order.
        codes.sort_by_key(|fault| &fault.code);
        codes.dedup_by_key(|fault| &fault.code);
        for fault in codes {
            // Files fail for more than one reason: what the system said stands behind the name.
            let reason = (record.status == Status::Failed).then(|| fault.message.rsplit_once(": ")).flatten();
            let reason = reason.map_or("", |(_, reason)| reason);
            let message = if reason.is_empty() { &fault.message } else { reason };
            by_code.entry((&fault.code, reason)).or_insert((0, message, &record.output)).0 += 1;
        }
    }
    if by_code.is_empty() {
        return String::new();
    }
    let mut text = format!("{title}:\n");
    for ((code, _), (count, message, first)) in by_code {
        let more = if count > 1 { ", …" } else { "" };
        text.push_str(&format!("{count:8}  {code}  {message}: {first}{more}\n"));
    }
    text
}
