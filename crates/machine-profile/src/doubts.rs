//! What a profile that can be read may still not mean: warnings.

use diagnostic::{Diagnostic, Text, both};
use machine_model::engines::Made;
use machine_model::{Axis, AxisTables, EngineId, Squareness, Vector};
use measurement_files::OddSizes;
use units::Length;

use crate::error::{DOUBTFUL_FIELD, NO_ERRORS, ODD_SIZES};
use crate::profile::{LatheParts, Profile};

impl Profile {
    /// What it leaves in doubt where this engine uses it: vectors of a field, sizes of errors, or that it holds none.
    #[must_use]
    pub fn doubts(&self, engine: EngineId) -> Vec<Diagnostic> {
        if engine == EngineId::Field {
            return self.doubts_of_field();
        }
        let mut doubts = self.odd_sizes();
        if engine != EngineId::Tracker && !self.has_errors() {
            let message = both!(
                "the profile holds no errors: nothing is corrected by it",
                "в профиле нет погрешностей: по нему ничего не исправляется"
            );
            let help = both!(
                "measure the machine (`vpost calibrate`) and name its tables, [axis.X] errors, [squareness]; where the machine is meant to be perfect, nothing is wrong",
                "измерьте станок (`vpost calibrate`) и впишите таблицы, [axis.X] errors, [squareness]; если станок нарочно идеальный, всё верно"
            );
            doubts.push(Diagnostic::warning(NO_ERRORS, message).help(help));
        }
        doubts
    }

    /// Tables of each axis, with the key that names them.
    fn tables(&self) -> impl Iterator<Item = (Axis, &'static str, &AxisTables)> {
        self.chain().axes().flat_map(|axis| {
            let k = axis.direction();
            let (linear, rotary) = (&self.description.linear[k], &self.description.rotary[k]);
            let [errors, negative] = if axis.is_linear() {
                [&linear.errors, &linear.errors_negative]
            } else {
                [&rotary.errors, &rotary.errors_negative]
            };
            let named = [("errors", errors), ("errors_negative", negative)];
            named.into_iter().filter_map(move |(key, tables)| Some((axis, key, tables.as_ref()?)))
        })
    }

    fn odd_sizes(&self) -> Vec<Diagnostic> {
        let of_table = |(axis, key, tables): (Axis, &str, &AxisTables)| {
            let section = if axis.is_linear() { "axis" } else { "rotary" };
            let source = format!("[{section}.{axis}] {key}");
            let odd = |f: usize| {
                let values = tables.nodes().iter().map(|q| tables.at(*q)[f]);
                let name = format!("E{}{axis}", Axis::ALL[f]);
                let odd = OddSizes::of(&source, &name, f, values)?;
                Some(Diagnostic::warning(ODD_SIZES, odd.message).help(odd.help))
            };
            (0..6).filter_map(odd).collect::<Vec<_>>()
        };
        self.tables().flat_map(of_table).collect()
    }

    /// What its error vectors leave in doubt.
    fn doubts_of_field(&self) -> Vec<Diagnostic> {
        let Some(measured) = &self.field else { return Vec::new() };
        let mut doubts = Vec::new();
        if let Some(doubt) = measured.field.doubt() {
            let [stated, scatter] = [doubt.stated_mm, doubt.scatter_mm].map(|mm| Length::from_mm(mm).um());
            let message = both!(
                "{}: the vectors scatter by {scatter:.2} um about the field that fits them, and {stated:.2} um are stated",
                "{}: векторы рассеяны около поля, проведённого по ним, на {scatter:.2} мкм, а задано {stated:.2} мкм",
                measured.file
            );
            let help = if scatter > stated {
                both!(
                    "state the noise that repeated readings show: with too little the field follows it",
                    "задайте шум, который показывают повторные отсчёты: при слишком малом поле повторяет его"
                )
            } else {
                both!(
                    "state the noise that repeated readings show: with too much the field is smoother than the machine",
                    "задайте шум, который показывают повторные отсчёты: при слишком большом поле глаже станка"
                )
            };
            doubts.push(Diagnostic::warning(DOUBTFUL_FIELD, message).help(help));
        }
        if let Some(mm) = measured.field.blind_to_mm() {
            let message = both!(
                "{}: its runs have too few places in common: an offset between them of up to {:.0} um would pass for the machine",
                "{}: у его серий слишком мало общих точек: сдвиг между ними до {:.0} мкм сошёл бы за станок",
                measured.file,
                Length::from_mm(mm).um()
            );
            let help = both!(
                "where each run had a set-up of its own, measure some places in all of them; where all had one, give them one name",
                "если у каждой серии была своя установка, измерьте часть точек во всех; если установка одна, назовите серии одинаково"
            );
            doubts.push(Diagnostic::warning(DOUBTFUL_FIELD, message).help(help));
        }
        if let Made::Smooth { missing: missing @ 1.., .. } = measured.field.made() {
            let message = both!(
                "{}: the lattice of its places lacks {missing} node(s)",
                "{}: в решётке его точек недостаёт узлов: {missing}",
                measured.file
            );
            let help = both!(
                "the vectors are smoothed as scattered ones; measure the missing nodes where that matters",
                "векторы сглажены как разрозненные; измерьте недостающие узлы, если это важно"
            );
            doubts.push(Diagnostic::warning(DOUBTFUL_FIELD, message).help(help));
        }
        doubts.extend(self.passed_over(&measured.file));
        doubts
    }

    /// Errors of axes that stand beside the vectors: whoever wrote them may take them for corrected as well.
    fn passed_over(&self, file: &str) -> Option<Diagnostic> {
        let mut named: Vec<Text> = Vec::new();
        for (axis, name) in self.description.linear.iter().zip(["X", "Y", "Z"]) {
            if axis.errors.is_some() || axis.errors_negative.is_some() || axis.backlash_mm != 0.0 {
                named.push(Text::same(format!("[axis.{name}]")));
            }
        }
        let square = &self.description.squareness;
        if [square.ec0y_rad, square.eb0z_rad, square.ea0z_rad].iter().any(|angle| *angle != 0.0) {
            named.push(Text::same("[squareness]".to_owned()));
        }
        if named.is_empty() {
            return None;
        }
        let named = Text::join(&named, ", ");
        let message = both!(
            "the errors in {named} are not used: the engine field knows the vectors of {file} alone",
            "погрешности из {named:#} не используются: метод field знает только векторы из {file}"
        );
        let help = both!(
            "the vectors hold what bends the machine already; take the errors of the axes out, or correct by them: --engine rigid-body",
            "всё, что искривляет станок, уже в векторах; уберите погрешности осей или исправляйте по ним: --engine rigid-body"
        );
        Some(Diagnostic::warning(DOUBTFUL_FIELD, message).help(help))
    }

    /// True where the rigid-body model errs anywhere; by a profile without errors nothing is corrected.
    #[must_use]
    pub fn has_errors(&self) -> bool {
        let table =
            |(_, _, tables): (_, _, &AxisTables)| tables.nodes().iter().any(|q| tables.at(*q) != [0.0; 6]);
        let rotary = |axis: Axis| {
            let (own, k) = (&self.description.rotary[axis.direction()], axis.direction());
            let elsewhere = |centres: &[[f64; 3]; 3]| Vector::from(centres[k]) != own.centre_mm;
            own.shift_mm != Vector::zeros()
                || own.tilt_rad != Vector::zeros()
                || own.backlash_rad != 0.0
                || self.kinematics.as_ref().is_some_and(|control| elsewhere(&control.centres_mm))
        };
        self.description.squareness != Squareness::default()
            || self.description.linear.iter().any(|axis| axis.backlash_mm != 0.0)
            || !self.effects.is_empty()
            || self.tables().any(table)
            || self.chain().axes().filter(|axis| !axis.is_linear()).any(rotary)
            || self.lathe.as_ref().is_some_and(LatheParts::hold_errors)
    }
}

impl LatheParts {
    fn hold_errors(&self) -> bool {
        let spindle = &self.spindle;
        let right = turning::Spindle { centre_mm: spindle.centre_mm, ..turning::Spindle::default() };
        let tailstock = spindle.tailstock.is_none_or(|tailstock| tailstock.offset_mm == [0.0; 2]);
        let alone = turning::Spindle { tailstock: None, ..spindle.clone() };
        alone != right
            || !tailstock
            || !self.bending.is_none()
            || !self.stations.is_empty()
            || self.tip != turning::Tip::default()
    }
}
