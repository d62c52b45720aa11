//! Sizes that errors of machines have.

use diagnostic::{Text, both};
use machine_model::Component;

/// Errors of a size that no machine has in the unit that is said.
pub struct OddSizes {
    /// Nine of ten are below what any machine's are; else above.
    pub are_small: bool,
    /// What is odd.
    pub message: Text,
    /// Where to look.
    pub help: Text,
}

/// Factor from mm or rad to what is printed, and its unit.
#[must_use]
pub fn micro(component: Component) -> (f64, Text) {
    match component {
        Component::Linear => (1e3, Text::pair("um", "мкм")),
        Component::Angular => (1e6, Text::pair("urad", "мкрад")),
    }
}

impl OddSizes {
    /// Of values in mm or rad that a source has of an error function, 0 to 5; `None` where they are of the usual size.
    #[must_use]
    pub fn of(source: &str, name: &str, function: usize, values: impl Iterator<Item = f64>) -> Option<Self> {
        let component = Component::of(function);
        let mut sizes: Vec<f64> = values.map(f64::abs).collect();
        sizes.sort_by(f64::total_cmp);
        let large = sizes.get(sizes.len() * 9 / 10).copied().unwrap_or(0.0);
        // 0.05 µm and 0.05 µrad; 0.5 mm and 5 mrad.
        let (low, high, least) = match component {
            Component::Linear => (5e-5, 0.5, Text::pair("0.05 um", "0.05 мкм")),
            Component::Angular => (5e-8, 5e-3, Text::pair("0.05 urad", "0.05 мкрад")),
        };
        if large > 0.0 && large < low && sizes.len() > 3 {
            let message = both!(
                "{source}: nine readings of ten of {name} are below {least}: are they in a larger unit than said?",
                "{source}: девять показаний {name} из десяти меньше {least:#}: их единица крупнее названной?"
            );
            let help = both!(
                "no machine is that good: check µm against mm, µrad against arc seconds; leave out a column that holds nothing (--ignore-column)",
                "таких точных станков нет: проверьте, не мм ли вместо мкм, не угловые ли секунды вместо мкрад; столбец, где ничего нет, пропустите (--ignore-column)"
            );
            return Some(Self { are_small: true, message, help });
        }
        let (scale, unit) = micro(component);
        (large > high).then(|| Self {
            are_small: false,
            message: both!(
                "{source}: readings of {name} reach {:.0} {unit}: are they in a smaller unit than said?",
                "{source}: показания {name} доходят до {:.0} {unit:#}: их единица мельче названной?",
                large * scale
            ),
            help: both!(
                "check µm against mm and nm, µrad against arc seconds",
                "проверьте, мкм ли это, а не мм или нм, мкрад ли, а не угловые секунды"
            ),
        })
    }
}
