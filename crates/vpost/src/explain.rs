//! What a message means, from the page that explains them all.

use clap::Args;
use diagnostic::{Language, notice};

use crate::file;
use crate::message::{Failure, OPTION};

/// `docs/diagnostics.md`: an entry for each number.
const PAGE: &str = include_str!(env!("DIAGNOSTICS_PAGE"));

/// `docs/diagnostics.ru.md`: the same in Russian.
const PAGE_RU: &str = include_str!(env!("DIAGNOSTICS_PAGE_RU"));

/// `vpost explain`
#[derive(Debug, Args)]
pub struct Explain {
    /// Number of a message: VP0509, or 509.
    #[arg(value_name = "CODE")]
    pub code: String,
}

/// Prints the entry of a message.
pub(crate) fn run(arguments: &Explain, language: Language) -> Result<(), Failure> {
    let code = &arguments.code;
    let digits = code.strip_prefix("VP").or_else(|| code.strip_prefix("vp")).unwrap_or(code);
    let entry = digits.parse::<u16>().ok().and_then(|number| entry(page(language), number));
    let Some(entry) = entry else {
        return Err(Failure::usage(notice!(OPTION;
            "there is no message `{code}`", "сообщения `{code}` нет";
            "give the number that stands in brackets behind `error` or `warning`, like VP0509",
            "дайте номер, который стоит в скобках после слова «ошибка» или «предупреждение», например VP0509"
        )));
    };
    file::print(format!("{entry}\n").as_bytes())
}

/// What a message is about, in the few words of its entry's heading.
pub(crate) fn title(code: &str, language: Language) -> Option<&'static str> {
    let heading = format!("### {code} — ");
    let page = page(language);
    let rest = &page[page.find(&heading)? + heading.len()..];
    let title = rest.lines().next()?;
    Some(title.strip_prefix("warning: ").or_else(|| title.strip_prefix("предупреждение: ")).unwrap_or(title))
}

fn page(language: Language) -> &'static str {
    match language {
        Language::English => PAGE,
        Language::Russian => PAGE_RU,
    }
}

/// The part of a page under the heading of a number, without the example that causes the message.
fn entry(page: &str, number: u16) -> Option<String> {
    let heading = format!("### VP{number:04} ");
    let at = page.find(&heading)?;
    let rest = &page[at + "### ".len()..];
    let end = rest.find("\n#").unwrap_or(rest.len());
    let text = rest[..end].split("\n```").next().unwrap_or_default();
    Some(text.trim_end().to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_entry_ends_before_its_example() {
        let page = "# M\n\n### VP0001 — one\n\nText\nof it.\n\n```nc\nG0\n```\n\n### VP0002 — two\n\nMore.\n";
        assert_eq!(entry(page, 1).unwrap(), "VP0001 — one\n\nText\nof it.");
        assert_eq!(entry(page, 2).unwrap(), "VP0002 — two\n\nMore.");
        assert_eq!(entry(page, 3), None);
    }
}
