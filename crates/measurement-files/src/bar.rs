//! Readings of ball bars: between two places, or as angle and deviation on a circle.

use std::collections::BTreeMap;

use diagnostic::{Code, both};
use machine_model::Vector;
use units::math;

use crate::codes::OPEN;
use crate::refusal::Refusal;
use crate::sheet::{Row, Sheet};

/// One reading of a ball bar, machine coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bar {
    /// The ball at the tool, as commanded, mm.
    pub ball_mm: Vector,
    /// The other ball, mm.
    pub centre_mm: Vector,
    /// Measured distance, mm.
    pub length_mm: f64,
    /// Direction of motion of each axis: -1, 0 (unknown, or at rest), 1.
    pub direction: [i8; 3],
}

const CENTRE: [&str; 3] = ["bx_mm", "by_mm", "bz_mm"];

/// An arc that leaves more of the circle open than this does not tell centre, squareness and scale apart, degrees. The
/// partial arcs that instruments offer (220 degrees) leave 140.
const LARGEST_GAP_DEG: f64 = 150.0;

/// A plane's two axes, the angle counting from the first to the second: ISO 230-4, right-handed about the third.
fn axes(plane: &str) -> Option<[usize; 2]> {
    match plane.to_uppercase().replace('Х', "X").replace('У', "Y").as_str() {
        "XY" => Some([0, 1]),
        "YZ" => Some([1, 2]),
        "ZX" => Some([2, 0]),
        _ => None,
    }
}

impl Sheet {
    /// True for readings of a ball bar as angle and deviation.
    #[must_use]
    pub fn is_polar(&self) -> bool {
        self.has("angle_deg")
    }

    /// Refuses readings of a ball bar that lack a column, and circles that are less than partial arcs.
    ///
    /// # Errors
    /// The column; the run and how much of its circle it covers.
    pub fn need_bars(&self) -> Result<(), Box<Refusal>> {
        if !self.is_polar() {
            let help = both!(
                "a reading of a ball bar is a length between two balls",
                "показание телескопического измерителя — длина между двумя шарами"
            );
            self.need(&["x_mm", "y_mm", "z_mm"], help)?;
            let help = both!(
                "a ball-bar length needs the centre of the fixed ball",
                "для длины измерителя нужен центр неподвижного шара"
            );
            return self.need(&[&CENTRE[..], &["length_mm"]].concat(), help);
        }
        self.need(
            &[&["plane", "radius_mm", "deviation_um"], &CENTRE[..]].concat(),
            both!("a polar reading needs plane, radius_mm, deviation_um and the circle's centre bx_mm,by_mm,bz_mm", "для полярного показания нужны plane, radius_mm, deviation_um и центр окружности bx_mm,by_mm,bz_mm"),
        )?;
        for (column, place) in
            [("x_mm", both!("the angle", "угол")), ("length_mm", both!("the deviation", "отклонение"))]
        {
            if self.has(column) {
                let message = both!(
                    "column `{column}` stands beside angle_deg: {place} says the same",
                    "столбец `{column}` стоит рядом с angle_deg: то же говорит {place:#}"
                );
                let help = both!("keep one of the two forms", "оставьте одну из двух форм");
                return Err(self.refuse_column(self.codes().column, column, message, help));
            }
        }
        let mut runs: BTreeMap<_, Vec<f64>> = BTreeMap::new();
        for row in self.rows() {
            runs.entry(row.text("run")).or_default().push(row.needed("angle_deg")?.rem_euclid(360.0));
        }
        for (run, mut angles) in runs {
            angles.sort_by(f64::total_cmp);
            let first = angles[0] + 360.0;
            let gaps = angles.iter().zip(angles.iter().skip(1).chain([&first])).map(|(a, b)| b - a);
            let gap = gaps.fold(0.0, f64::max);
            if gap > LARGEST_GAP_DEG {
                let message = both!(
                    "run `{run}` covers {:.0} degrees of its circle",
                    "проход `{run}` охватывает {:.0}° своей окружности",
                    360.0 - gap
                );
                let help = both!(
                    "measure 220 degrees at least: from less, the centre cannot be told from squareness and scale",
                    "измеряйте не меньше 220 градусов: на меньшей дуге центр не отличить от перпендикулярности и масштаба"
                );
                return Err(self.refuse_column(OPEN, "angle_deg", message, help));
            }
        }
        Ok(())
    }
}

impl Row<'_> {
    /// The key of what a ball bar read.
    #[must_use]
    pub fn bar_key(&self) -> &'static str {
        if self.sheet().is_polar() { "deviation_um" } else { "length_mm" }
    }

    /// A reading of a ball bar.
    ///
    /// As places: `x_mm` to `z_mm`, `bx_mm` to `bz_mm`, `length_mm`, `dir_x` to `dir_z`. As angle and deviation: the ball is at
    /// `angle_deg` on the circle of `radius_mm` about `bx_mm` to `bz_mm` in `plane`, `dir` is +1 for rising angles, and the
    /// length is the radius plus `deviation_um`.
    ///
    /// # Errors
    /// As [`Self::needed`]; a plane that is none.
    pub fn bar(&self) -> Result<Bar, Box<Refusal>> {
        let centre_mm = Vector::from(self.three(CENTRE)?);
        if !self.sheet().is_polar() {
            return Ok(Bar {
                ball_mm: self.three(["x_mm", "y_mm", "z_mm"])?.into(),
                centre_mm,
                length_mm: self.needed("length_mm")?,
                direction: self.directions()?,
            });
        }
        let plane = self.text("plane");
        let Some(axes) = axes(&plane) else {
            let help = both!(
                "write XY, YZ or ZX: the angle counts from the first axis to the second",
                "напишите XY, YZ или ZX: угол считается от первой оси ко второй"
            );
            let code: Code = self.sheet().codes().cell;
            let message = both!("`{plane}` is no plane", "`{plane}` — не плоскость");
            return Err(self.refuse(code, "plane", message, help));
        };
        let radius_mm = self.needed("radius_mm")?;
        let angle_rad = self.needed("angle_deg")?.to_radians();
        let (sin, cos) = (math::sin(angle_rad), math::cos(angle_rad));
        let sense = self.sign("dir")?;
        let mut bar = Bar {
            ball_mm: centre_mm,
            centre_mm,
            length_mm: radius_mm + 1e-3 * self.needed("deviation_um")?,
            direction: [0; 3],
        };
        for (axis, share, motion) in [(axes[0], cos, -sin), (axes[1], sin, cos)] {
            /// Slower than this part of the feed an axis is turning round.
            const AT_REST: f64 = 1e-6;
            bar.ball_mm[axis] += radius_mm * share;
            bar.direction[axis] = sense * (i8::from(motion > AT_REST) - i8::from(motion < -AT_REST));
        }
        Ok(bar)
    }
}
