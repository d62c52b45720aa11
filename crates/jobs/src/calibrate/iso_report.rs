//! ISO 230-2 as an instrument prints it.

use calibration::iso230_2::{Direction, Evaluation, Uncertain};
use diagnostic::{Text, both};

/// One of the standard's figures.
pub(super) struct Figure {
    /// `A↑`
    pub(super) symbol: &'static str,
    pub(super) name: Text,
    pub(super) found: Uncertain,
}

/// What has a figure for each direction: its symbols, its name, and the figure itself.
type OfDirections = ([&'static str; 3], Text, Uncertain, fn(&Direction) -> Uncertain);

/// The figures that the runs give, in the order in which they are printed.
pub(super) fn figures(e: &Evaluation) -> Vec<Figure> {
    let accuracy: OfDirections =
        (["A", "A↑", "A↓"], Text::pair("accuracy", "точность"), e.accuracy, |d| d.accuracy);
    let systematic: OfDirections = (
        ["E", "E↑", "E↓"],
        Text::pair("systematic deviation", "систематическое отклонение"),
        e.systematic,
        |d| d.systematic,
    );
    let repeatability: OfDirections = (
        ["R", "R↑", "R↓"],
        Text::pair("repeatability", "повторяемость"),
        e.repeatability,
        |d| d.repeatability,
    );
    let three = |([both, up, down], name, found, of): OfDirections| {
        let one = |symbol, found: Option<Uncertain>, how: Text| {
            found.map(|found| Figure { symbol, name: Text::join([&name, &how], ", "), found })
        };
        [
            one(both, Some(found), Text::pair("both directions", "в обоих направлениях")),
            one(up, e.positive.as_ref().map(of), Text::pair("up", "вверх")),
            one(down, e.negative.as_ref().map(of), Text::pair("down", "вниз")),
        ]
    };
    let range = Text::pair("range of the bidirectional means", "размах двунаправленных средних");
    let range = Figure { symbol: "M", name: range, found: e.mean_range };
    let largest = Text::pair("largest reversal value", "наибольшая зона нечувствительности (реверс)");
    let reversal = e.reversal.map(|found| Figure { symbol: "B", name: largest, found });
    let means = [accuracy, systematic].map(three).into_iter().flatten();
    means.chain([Some(range)]).chain(three(repeatability)).chain([reversal]).flatten().collect()
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
