//! The table at the end.

use std::collections::BTreeMap;

use diagnostic::{Language, Text, both, russian_plural};

use super::causes;
use super::record::{Fault, Record, Status};
use super::work::Results;

static HEADER: Text = Text::pair(
    "            programs      MB in     MB out\n",
    "              программ   МБ вход   МБ выход\n",
);

/// The results in a few lines: how many, how far off, and what was refused for which reason.
pub(crate) fn table(results: &Results, language: Language) -> String {
    let records = &results.records;
    let mut text = HEADER.in_language(language).to_owned();
    let mut say = |said: &Text| text.push_str(said.in_language(language));
    for (status, name) in [
        (Status::Corrected, Text::pair("corrected", "исправлено")),
        (Status::Unchanged, Text::pair("unchanged", "без изменений")),
        (Status::Refused, Text::pair("refused", "не принято")),
        (Status::Failed, Text::pair("failed", "не удалось")),
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
            let [english, russian] = Language::ALL.map(|language| name.in_language(language).to_owned());
            say(&Text::new(
                format!("{english:<12}{count:8}{into:11.3}{out}\n"),
                format!("{russian:<14}{count:8}{into:11.3}{out}\n"),
            ));
        }
    }
    if results.resumed > 0 {
        say(&both!(
            "{} of them were done by an earlier run\n",
            "из них сделано прежним запуском: {}\n",
            results.resumed
        ));
    }
    let largest = records
        .iter()
        .filter_map(|record| Some((record.figures.as_ref()?, &record.output)))
        .reduce(|a, b| if b.0.largest_correction_um > a.0.largest_correction_um { b } else { a });
    if let Some((figures, output)) = largest {
        say(&both!(
            "largest correction: {:.1} um ({output}, line {})\n",
            "наибольшая поправка: {:.1} мкм ({output}, строка {})\n",
            figures.largest_correction_um,
            figures.largest_correction_line
        ));
    }
    let after = records.iter().filter_map(|record| Some(record.figures.as_ref()?.deviation_after_um));
    let before = records.iter().filter_map(|record| Some(record.figures.as_ref()?.deviation_before_um));
    if let (Some(before), Some(after)) = (before.reduce(f64::max), after.reduce(f64::max)) {
        say(&both!(
            "paths off by at most {before:.1} um before, {after:.2} um after\n",
            "отклонение от траектории не больше {before:.1} мкм до, {after:.2} мкм после\n"
        ));
    }
    say(&causes::causes(records));
    say(&warnings(records));
    let older: Vec<&str> =
        records.iter().filter(|record| record.older_output).map(|record| record.output.as_str()).collect();
    if let Some(first) = older.first() {
        let (count, more) = (older.len(), if older.len() == 1 { "" } else { ", …" });
        let have = if count == 1 { "has" } else { "have" };
        let outputs =
            russian_plural(count as u64, ["устаревший файл", "устаревших файла", "устаревших файлов"]);
        say(&Text::new(
            format!(
                "{count} of these still {have} an output of an earlier run, which is out of date: {first}{more}\n"
            ),
            format!("на месте выходных остались от прежнего запуска {count} {outputs}: {first}{more}\n"),
        ));
    }
    text
}

/// Numbers of warnings with how many programs have them and the first of those.
fn warnings(records: &[Record]) -> Text {
    let mut by_code: BTreeMap<&str, (usize, &str, &str)> = BTreeMap::new();
    for record in records {
        let mut codes: Vec<&Fault> = record.warnings.iter().collect();
        // The first of each stays: sorting keeps their order.
        codes.sort_by_key(|fault| &fault.code);
        codes.dedup_by_key(|fault| &fault.code);
        for fault in codes {
            by_code.entry(&fault.code).or_insert((0, &fault.message, &record.output)).0 += 1;
        }
    }
    let mut text = if by_code.is_empty() {
        Text::EMPTY
    } else {
        both!("warnings:\n", "предупреждения:\n")
    };
    for (code, (count, message, first)) in by_code {
        text.push(&causes::line(count, code, message, first));
    }
    text
}
