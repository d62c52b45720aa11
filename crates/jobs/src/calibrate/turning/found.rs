//! What test pieces say: the report, and its JSON.

use calibration::turning::{
    FoundTerm, HeldOut, LEVEL, Offset, Term, TurnedReading, TurningBase, TurningCalibration, Uncertainty,
};
use diagnostic::{Text, both};
use serde_json::{Value, json};

/// What was found of the parts, and what that rests on.
pub(super) struct Outcome<'a> {
    pub(super) found: &'a TurningCalibration,
    pub(super) holdout: Option<HeldOut>,
    /// The hold-out got worse, so that nothing was written.
    pub(super) is_refuted: bool,
    pub(super) base: &'a TurningBase,
    pub(super) names: &'a Names,
    /// Readings that the adjustment saw.
    pub(super) rows: &'a [TurnedReading],
    /// All diameters say when they were cut.
    pub(super) timed: bool,
}

/// Names of parts and tools, by their numbers.
#[derive(Default)]
pub(super) struct Names {
    pub(super) parts: Vec<String>,
    pub(super) tools: Vec<String>,
}

/// Name in the profile, what the base says, and from the unit of the adjustment.
pub(super) fn named(term: Term, base: &TurningBase) -> (&'static str, f64, f64) {
    match term {
        Term::Axis => match base.spindle.tailstock {
            Some(tailstock) => ("tailstock.offset_um.X", tailstock.offset_mm[0], 1e3),
            None => ("spindle.EB0S_urad", base.spindle.tilt_rad[1], 1e6),
        },
        Term::Squareness => ("squareness.EB0Z_urad", base.description.squareness.eb0z_rad, 1e6),
        Term::Growth => ("growth_um_per_h", 0.0, 1e3),
        Term::Wear => ("wear_um_per_part", 0.0, 1e3),
        Term::Bow => ("axis.Z.EXZ_bow_um", 0.0, 1e3),
        Term::FourthOrder => ("axis.Z.EXZ_order4_um", 0.0, 1e3),
        Term::PartToPart => ("change_um_per_part", 0.0, 1e3),
    }
}

/// Name of a tool or, where there is none, of its part.
pub(super) fn owner(found: &Offset, names: &Names) -> String {
    match found.tool {
        Some(tool) => names.tools[tool].clone(),
        None => names.parts[found.part].clone(),
    }
}

impl Outcome<'_> {
    pub(super) fn report(&self) -> Text {
        let Self { found, holdout, base, names, .. } = *self;
        let parts = found.shared_mm.map(|mm| mm * 1e3).map_or_else(
            || both!("are too few to tell by how much they differ", "неизвестно: их слишком мало"),
            |um| both!("by {um:.3} um beyond that", "сверх того {um:.3} мкм"),
        );
        let mut out = both!(
            "test pieces: diameters scatter by {:.3} um (standard deviation), parts {parts}\n",
            "образцы: разброс диаметров {:.3} мкм (стандартное отклонение), между образцами {parts:#}\n",
            found.noise_mm * 1e3
        );
        for own in found.terms.iter().chain(&found.not_there) {
            let (key, before, scale) = named(own.term, base);
            let said = match (own.is_significant, own.term.is_geometry()) {
                (false, _) => Text::pair("not significant, not written", "незначимо, не записано"),
                (true, true) => Text::pair("written", "записано"),
                (true, false) => Text::pair("in the report only", "только в отчёте"),
            };
            let (value, half) = ((before + own.value) * scale, own.u.half_width_95() * scale);
            let name = own.term.words();
            out.push(&both!(
                "  {name:<10} {key} {value:.3} ± {half:.3}, {said}\n",
                "  {name:<#10} {key} {value:.3} ± {half:.3}, {said:#}\n"
            ));
        }
        out.push(&both!(
            "  level of the F tests: {} %; intervals are 95 %\n",
            "  уровень F-критериев: {} %; интервалы 95-процентные\n",
            LEVEL * 100.0
        ));
        for open in self.not_told_apart() {
            out.push(&both!("  {open}\n", "  {open:#}\n"));
        }
        for offset in &found.offsets {
            let interval =
                offset.u.map_or_else(String::new, |u| format!(" ± {:.3}", u.half_width_95() * 1e3));
            let (owner, radius_um) = (owner(offset, names), offset.radius_mm * 1e3);
            let wear_mm = -2.0 * offset.radius_mm;
            out.push(&both!(
                "  size of {owner}: {radius_um:.3}{interval} um on the radius; with this profile enter {wear_mm:.4} mm as wear of X on the diameter\n",
                "  размер {owner}: {radius_um:.3}{interval} мкм на радиус; с этим профилем введите износ по X {wear_mm:.4} мм на диаметр\n"
            ));
        }
        if found.unseen_blunder_mm > 0.0 {
            out.push(&both!(
                "  one reading that is wrong by less than {:.1} um may have passed: more places or parts would show it\n",
                "  мог пройти один отсчёт с ошибкой меньше {:.1} мкм: его показали бы другие места или образцы\n",
                found.unseen_blunder_mm * 1e3
            ));
        }
        let [before, after] = found.rms_mm.map(|mm| mm * 1e3);
        out.push(&both!(
            "fitted {before:.3} -> {after:.3} um RMS on the diameter\n",
            "подгонка: СКЗ {before:.3} -> {after:.3} мкм на диаметр\n"
        ));
        if let Some(HeldOut { rows, rms_before_mm, rms_after_mm, max_after_mm }) = holdout {
            let [before, after, most] = [rms_before_mm, rms_after_mm, max_after_mm].map(|mm| mm * 1e3);
            out.push(&both!(
                "held out {before:.3} -> {after:.3} um RMS, at most {most:.3} um ({rows} diameters, each part at its own size)\n",
                "контрольные: СКЗ {before:.3} -> {after:.3} мкм, не больше {most:.3} мкм (диаметров {rows}, каждый образец по своему размеру)\n"
            ));
        }
        out
    }

    /// Pairs of causes that these parts leave open, and what would settle each.
    pub(super) fn not_told_apart(&self) -> Vec<Text> {
        let one = |[a, b]: &[Text; 2]| {
            let help = match (a.english(), b.english()) {
                ("growth", "wear") | ("wear", "growth") if !self.timed => {
                    Text::pair(": add the column time_s", "; добавьте столбец time_s")
                }
                ("growth", "wear") | ("wear", "growth") => Text::pair(
                    ": measure a second part with a new edge while warm, or cut the first size again when warm",
                    "; измерьте второй образец с новой кромкой на прогретом станке или проточите первый размер снова после прогрева",
                ),
                (_, "what else differs from part to part") => {
                    Text::pair(": measure a further part", "; измерьте ещё один образец")
                }
                _ => Text::EMPTY,
            };
            both!(
                "{a} and {b} cannot be told apart by these parts{help}",
                "по этим образцам не различить {a:#} и {b:#}{help:#}"
            )
        };
        self.found.not_told_apart.iter().map(one).collect()
    }

    pub(super) fn json(&self) -> Value {
        let Self { found, holdout, base, names, rows, .. } = *self;
        let known = |u: Uncertainty, scale: f64| {
            let freedom = u.freedom.is_finite().then_some(u.freedom);
            (u.standard * scale, freedom, u.half_width_95() * scale)
        };
        let term = |own: &FoundTerm| {
            let (name, before, scale) = named(own.term, base);
            let (u, freedom, u95) = known(own.u, scale);
            json!({ "name": name, "value": (before + own.value) * scale, "u": u, "degrees_of_freedom": freedom, "u95": u95,
                    "f": own.f, "significant": own.is_significant,
                    "written": own.is_significant && own.term.is_geometry() })
        };
        let scales: Vec<f64> = found.terms.iter().map(|own| named(own.term, base).2).collect();
        let row =
            |i: usize| (0..scales.len()).map(|k| found.covariance[(i, k)] * scales[i] * scales[k]).collect();
        let covariance: Vec<Vec<f64>> = (0..scales.len()).map(row).collect();
        let offset = |own: &Offset| {
            let known = own.u.map(|u| known(u, 1e3));
            json!({ "tool": owner(own, names), "radius_um": own.radius_mm * 1e3, "u_um": known.map(|u| u.0),
                    "degrees_of_freedom": known.and_then(|u| u.1), "u95_um": known.map(|u| u.2) })
        };
        let mut counted: Vec<usize> = rows.iter().map(|row| row.part).collect();
        counted.sort_unstable();
        counted.dedup();
        let mut out = json!({
            "schema": "vpost.turning/1",
            "parts": counted.len(),
            "rows": rows.len(),
            "noise_um": found.noise_mm * 1e3,
            "level": LEVEL,
            "part_to_part_um": found.shared_mm.map(|mm| mm * 1e3),
            "unseen_blunder_um": found.unseen_blunder_mm * 1e3,
            "terms": found.terms.iter().map(term).collect::<Vec<_>>(),
            "covariance": covariance,
            "not_significant": found.not_there.iter().map(term).collect::<Vec<_>>(),
            "not_told_apart": found.not_told_apart.iter().map(|pair| pair.each_ref().map(Text::english)).collect::<Vec<_>>(),
            "offsets": found.offsets.iter().map(offset).collect::<Vec<_>>(),
        });
        if let Some(judged) = holdout {
            out["holdout"] = json!({ "rows": judged.rows, "rms_before_um": judged.rms_before_mm * 1e3,
                "rms_after_um": judged.rms_after_mm * 1e3, "max_after_um": judged.max_after_mm * 1e3 });
        }
        out
    }
}
