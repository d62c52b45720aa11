//! ISO 230-2 as an instrument prints it.

use calibration::iso230_2::{Evaluation, Uncertain};
use diagnostic::{Text, both};

/// One of the standard's figures.
pub(super) struct Figure {
    /// `A↑`
    pub(super) symbol: &'static str,
    pub(super) name: Text,
    pub(super) found: Uncertain,
}

/// The figures that the runs give, in the order in which they are printed.
pub(super) fn figures(e: &Evaluation) -> Vec<Figure> {
    let of = |symbol, english, russian, found: Option<Uncertain>| {
        found.map(|found| Figure { symbol, name: Text::pair(english, russian), found })
    };
    let (up, down) = (e.positive, e.negative);
    [
        of("A", "accuracy, both directions", "точность, в обоих направлениях", Some(e.accuracy)),
        of("A↑", "accuracy, up", "точность, вверх", up.map(|d| d.accuracy)),
        of("A↓", "accuracy, down", "точность, вниз", down.map(|d| d.accuracy)),
        of(
            "E",
            "systematic deviation, both directions",
            "систематическое отклонение, в обоих направлениях",
            Some(e.systematic),
        ),
        of("E↑", "systematic deviation, up", "систематическое отклонение, вверх", up.map(|d| d.systematic)),
        of(
            "E↓",
            "systematic deviation, down",
            "систематическое отклонение, вниз",
            down.map(|d| d.systematic),
        ),
        of("M", "range of the bidirectional means", "размах двунаправленных средних", Some(e.mean_range)),
        of(
            "R",
            "repeatability, both directions",
            "повторяемость, в обоих направлениях",
            Some(e.repeatability),
        ),
        of("R↑", "repeatability, up", "повторяемость, вверх", up.map(|d| d.repeatability)),
        of("R↓", "repeatability, down", "повторяемость, вниз", down.map(|d| d.repeatability)),
        of("B", "largest reversal value", "наибольшая зона нечувствительности (реверс)", e.reversal),
    ]
    .into_iter()
    .flatten()
    .collect()
}

/// Lines of one axis. Deviations in mm or rad; shown in µm or µrad.
pub(super) fn lines(title: &str, e: &Evaluation, scale: f64, unit: &Text) -> Text {
    let v = |x: f64| format!("{:>9.3}", x * scale);
    let empty = || format!("{:>9}", "-");
    let (targets, [up, down]) = (e.targets.len(), e.runs);
    let mut out = both!(
        "ISO 230-2   {title}: {targets} targets, {up} runs up, {down} down; {unit}\n",
        "ISO 230-2   {title}: целей {targets}, проходов вверх {up}, вниз {down}; {unit:#}\n"
    );
    out.push(&Text::pair(
        "  target     mean up  mean down          B       s up     s down          R\n",
        "    цель   ср. вверх   ср. вниз          B    s вверх     s вниз          R\n",
    ));
    for t in &e.targets {
        let cell = |a: Option<f64>| a.map_or_else(empty, v);
        let [up, down] = [t.positive, t.negative].map(|a| cell(a.map(|a| a.mean)));
        let [s_up, s_down] = [t.positive, t.negative].map(|a| cell(a.map(|a| a.deviation)));
        let (at, b, r) = (crate::figures::short(t.position, 3), cell(t.reversal), v(t.repeatability));
        out.push(&Text::same(format!("{at:>8} {up} {down} {b}  {s_up}  {s_down}  {r}\n")));
    }
    for Figure { symbol, name, found } in figures(e) {
        let (value, u95) = (v(found.value), found.expanded * scale);
        out.push(&both!(
            "  {symbol:<3} {value} ± {u95:<8.3} {name}\n",
            "  {symbol:<3} {value} ± {u95:<8.3} {name:#}\n"
        ));
    }
    if let Some(b) = e.mean_reversal {
        out.push(&both!(
            "  B̄   {}            mean reversal value\n",
            "  B̄   {}            средняя зона нечувствительности (реверс)\n",
            v(b)
        ));
    }
    out
}
