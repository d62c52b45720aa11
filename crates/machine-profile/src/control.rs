//! `[control]`: the dialect, and what the control adds to the path.

use diagnostic::both;

use crate::error::VALUE;
use crate::format::{self, Blending, BlendingMode};
use crate::loader::Loader;
use crate::number::{Finite, Spanned};

/// Controls that round corners by more cut another part, mm.
const MOST_BLENDING_MM: f64 = 10.0;

/// What a profile says of the control.
#[derive(Debug, Default)]
pub(crate) struct Control {
    pub(crate) dialect: Option<String>,
    pub(crate) blending_mm: Option<f64>,
}

impl Loader<'_> {
    pub(crate) fn control(&mut self, written: Option<&Spanned<format::Control>>) -> Control {
        let Some(written) = written else { return Control::default() };
        match written.get_ref().clone() {
            format::Control::Dialect(name) => Control { dialect: Some(name), blending_mm: None },
            format::Control::More(rules) => Control {
                dialect: rules.dialect,
                blending_mm: rules.blending.and_then(|blending| self.blending_mm(written, blending)),
            },
        }
    }

    /// How far the control leaves the path at corners, mm.
    fn blending_mm(&mut self, at: &Spanned<format::Control>, blending: Blending) -> Option<f64> {
        let expected = match (blending.mode, blending.tolerance_mm) {
            (BlendingMode::ExactStop, None) => return Some(0.0),
            (BlendingMode::Unlimited, None) => return None,
            (BlendingMode::Tolerance, Some(Finite(mm))) if mm > 0.0 && mm <= MOST_BLENDING_MM => {
                return Some(mm);
            }
            (BlendingMode::Tolerance, _) => both!(
                "expected tolerance_mm above 0, up to {MOST_BLENDING_MM}, beside mode = \"tolerance\"",
                "рядом с mode = \"tolerance\" ожидалось tolerance_mm больше 0 и не больше {MOST_BLENDING_MM}"
            ),
            _ => both!(
                "tolerance_mm belongs to mode = \"tolerance\" alone",
                "tolerance_mm бывает только при mode = \"tolerance\""
            ),
        };
        let message = both!("`blending` of the control is not understood", "`blending` стойки непонятно");
        let help = both!(
            "write what the control's manual or its parameters say, like {{ mode = \"tolerance\", tolerance_mm = 0.005 }}",
            "напишите то, что сказано в руководстве или параметрах стойки, например {{ mode = \"tolerance\", tolerance_mm = 0.005 }}"
        );
        self.refuse(at, VALUE, message, expected, help);
        None
    }
}
