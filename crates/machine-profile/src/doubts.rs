//! What a profile that can be read may still not mean: warnings.

use diagnostic::{Diagnostic, both};
use machine_model::{Axis, AxisTables, EngineId, Squareness, Vector};
use measurement_files::OddSizes;

use crate::error::{NO_ERRORS, ODD_SIZES};
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
