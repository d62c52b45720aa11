//! What a profile that can be read may still not mean: warnings.

use diagnostic::Diagnostic;
use machine_model::{Axis, AxisTables, EngineId};
use measurement_files::OddSizes;

use crate::error::ODD_SIZES;
use crate::profile::Profile;

impl Profile {
    /// What it leaves in doubt where this engine uses it: vectors of a field, sizes of errors.
    #[must_use]
    pub fn doubts(&self, engine: EngineId) -> Vec<Diagnostic> {
        if engine == EngineId::Field {
            return self.doubts_of_field();
        }
        self.odd_sizes()
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
                let odd = OddSizes::of(&source, &name, f < 3, values)?;
                Some(Diagnostic::warning(ODD_SIZES, odd.message).help(odd.help))
            };
            (0..6).filter_map(odd).collect::<Vec<_>>()
        };
        self.tables().flat_map(of_table).collect()
    }
}
