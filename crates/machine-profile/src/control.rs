//! `[control]`: the dialect, and what the control adds to the path.

use diagnostic::both;

use crate::error::VALUE;
use crate::format::{self, Arcs, Blending, BlendingMode, FollowingRules};
use crate::loader::Loader;
use crate::number::{Each, Finite, Spanned};
use toolpath::{ArcChords, Following, Interpolator};

/// Controls that round corners by more cut another part, mm.
const MOST_BLENDING_MM: f64 = 10.0;
/// Longer chords are no arcs, mm.
const MOST_CHORD_MM: f64 = 10.0;
/// Ten times the acceleration of gravity: faster are units mistaken.
const MOST_ACCELERATION_MM_S2: f64 = 1e5;
/// Sampled a thousand times a second, a loop of a higher gain swings.
const MOST_GAIN_1_S: f64 = 1000.0;

/// What a profile says of the control.
#[derive(Debug, Default)]
pub(crate) struct Control {
    pub(crate) dialect: Option<String>,
    pub(crate) interpolator: Interpolator,
}

impl Loader<'_> {
    pub(crate) fn control(&mut self, written: Option<&Spanned<format::Control>>) -> Control {
        let Some(written) = written else { return Control::default() };
        match written.get_ref().clone() {
            format::Control::Dialect(name) => {
                Control { dialect: Some(name), interpolator: Interpolator::default() }
            }
            format::Control::More(rules) => Control {
                dialect: rules.dialect,
                interpolator: Interpolator {
                    blending_mm: rules.blending.and_then(|blending| self.blending_mm(written, blending)),
                    arcs: rules.arcs.and_then(|arcs| self.arcs(written, arcs)),
                    acceleration_mm_s2: self.acceleration_mm_s2(written, rules.acceleration_mm_s2),
                    following: rules.following.and_then(|rules| self.following(written, rules)),
                },
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

    /// How the control cuts arcs.
    fn arcs(&mut self, at: &Spanned<format::Control>, arcs: Arcs) -> Option<ArcChords> {
        let sensible = |mm: f64| mm > 0.0 && mm <= MOST_CHORD_MM;
        match (arcs.chord_mm, arcs.tolerance_mm) {
            (Some(Finite(mm)), None) if sensible(mm) => return Some(ArcChords::Length(mm)),
            (None, Some(Finite(mm))) if sensible(mm) => return Some(ArcChords::Tolerance(mm)),
            _ => {}
        }
        let message = both!("`arcs` of the control are not understood", "`arcs` стойки непонятны");
        let expected = both!(
            "expected chord_mm or tolerance_mm, above 0, up to {MOST_CHORD_MM}",
            "ожидалось chord_mm или tolerance_mm больше 0 и не больше {MOST_CHORD_MM}"
        );
        let help = both!(
            "write {{ chord_mm = 1.0 }} where chords have a length (Klipper, `resolution`), {{ tolerance_mm = 0.002 }} where they keep near the arc (Grbl, `$12`)",
            "напишите {{ chord_mm = 1.0 }}, если задана длина хорд (Klipper, `resolution`), или {{ tolerance_mm = 0.002 }}, если задано их удаление от дуги (Grbl, `$12`)"
        );
        self.refuse(at, VALUE, message, expected, help);
        None
    }

    /// Along the path, mm/s².
    fn acceleration_mm_s2(&mut self, at: &Spanned<format::Control>, written: Option<Finite>) -> Option<f64> {
        let Finite(acceleration) = written?;
        if acceleration > 0.0 && acceleration <= MOST_ACCELERATION_MM_S2 {
            return Some(acceleration);
        }
        let message = both!(
            "no machine accelerates by {acceleration} mm/s²",
            "ни один станок не разгоняется с {acceleration} мм/с²"
        );
        let expected = both!(
            "expected acceleration_mm_s2 above 0, up to {MOST_ACCELERATION_MM_S2}",
            "ожидалось acceleration_mm_s2 больше 0 и не больше {MOST_ACCELERATION_MM_S2}"
        );
        let help = both!("give it in mm/s²: 0.3 g are 2943", "задайте в мм/с²: 0,3 g — это 2943");
        self.refuse(at, VALUE, message, expected, help);
        None
    }
    /// How the axes follow.
    fn following(&mut self, at: &Spanned<format::Control>, rules: FollowingRules) -> Option<Following> {
        let following = Following {
            gain_1_s: rules.gain_1_s.axes(),
            feed_forward: rules.feed_forward.map_or([0.0; 3], Each::axes),
            in_position_mm: rules.in_position_mm.map(|Finite(mm)| mm),
        };
        let expected = if !following.gain_1_s.iter().all(|gain| *gain > 0.0 && *gain <= MOST_GAIN_1_S) {
            both!(
                "expected gain_1_s above 0, up to {MOST_GAIN_1_S}: a loop of another gain runs away or swings",
                "ожидалось gain_1_s больше 0 и не больше {MOST_GAIN_1_S}: с другим усилением контур теряет устойчивость"
            )
        } else if !following.feed_forward.iter().all(|share| (0.0..=1.0).contains(share)) {
            both!("expected feed_forward from 0 to 1", "ожидалось feed_forward от 0 до 1")
        } else if following.in_position_mm.is_some_and(|mm| mm <= 0.0 || mm > MOST_BLENDING_MM) {
            both!(
                "expected in_position_mm above 0, up to {MOST_BLENDING_MM}",
                "ожидалось in_position_mm больше 0 и не больше {MOST_BLENDING_MM}"
            )
        } else {
            return Some(following);
        };
        let message = both!("`following` of the control is not understood", "`following` стойки непонятно");
        let help = both!(
            "write the loops' gain, like {{ gain_1_s = 50, feed_forward = 0.9 }}; a lag of 1 mm at 1 m/min is 16.67 1/s",
            "напишите усиление контуров, например {{ gain_1_s = 50, feed_forward = 0.9 }}; отставание 1 мм при 1 м/мин — это 16,67 1/с"
        );
        self.refuse(at, VALUE, message, expected, help);
        None
    }
}
