//! Which way plus turns a rotary axis, in words that a machinist can test with his eyes.

use diagnostic::{Text, both};
use machine_model::{Axis, Chain, Vector};

use crate::profile::Profile;

/// What a turn of an axis towards plus does: to the table's side, to the tip of a tool in a head.
///
/// * `along` – the axis of rotation, about which plus turns right-handed
#[must_use]
pub fn plus_turns(chain: &Chain, axis: Axis, along: Vector) -> Text {
    let carries_workpiece = chain.table().contains(&axis);
    let moved = |place: Vector| named(along.cross(&place));
    if !carries_workpiece && along.z.abs() < 0.9 * along.norm() {
        let way = moved(-Vector::z());
        return both!(
            "plus {axis}: the tip of a tool that points down goes towards {way}",
            "плюс {axis}: вершина инструмента, направленного вниз, идёт к {way}"
        );
    }
    let side =
        (0..3).map(|k| Vector::ith(k, 1.0)).min_by(|a, b| along.dot(a).abs().total_cmp(&along.dot(b).abs()));
    let (side, carried) = (
        side.unwrap_or_else(Vector::x),
        if carries_workpiece { both!("table", "стола") } else { both!("head", "головы") },
    );
    let (from, way) = (named(side), moved(side));
    both!(
        "plus {axis}: the side of the {carried} towards {from} goes towards {way}",
        "плюс {axis}: сторона {carried:#}, обращённая к {from}, идёт к {way}"
    )
}

/// The axis of the machine along which a vector goes most: `+Y`.
fn named(v: Vector) -> String {
    let most = (0..3).fold(0, |most, k| if v[k].abs() > v[most].abs() + 1e-9 { k } else { most });
    format!("{}{}", if v[most] < 0.0 { '-' } else { '+' }, Axis::ALL[most])
}

impl Profile {
    /// What a turn of a rotary axis towards plus does.
    #[must_use]
    pub fn plus_turns(&self, axis: Axis) -> Text {
        let along = self.description.rotary[axis.direction()].direction;
        let along = along.unwrap_or_else(|| Vector::ith(axis.direction(), 1.0));
        plus_turns(self.chain(), axis, along)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn plus_turns_right_handed_about_its_line() {
        let [of_table, of_head] =
            ["[w C B A X Y b Z t]", "[w X Y b Z C B A t]"].map(|chain| Chain::parse(chain).expect("a chain"));
        for (axis, along, table, head) in [
            (
                Axis::A,
                [1.0, 0.0, 0.0],
                "the side of the table towards +Y goes towards +Z",
                "down goes towards +Y",
            ),
            (
                Axis::B,
                [0.0, 1.0, 0.0],
                "the side of the table towards +X goes towards -Z",
                "down goes towards -X",
            ),
            (
                Axis::C,
                [0.0, 0.0, 1.0],
                "the side of the table towards +X goes towards +Y",
                "head towards +X goes towards +Y",
            ),
            (
                Axis::C,
                [0.0, 0.0, -1.0],
                "the side of the table towards +X goes towards -Y",
                "head towards +X goes towards -Y",
            ),
            // A nutating table, 45 degrees.
            (
                Axis::B,
                [0.0, 0.7, 0.7],
                "the side of the table towards +X goes towards +Y",
                "down goes towards -X",
            ),
        ] {
            for (chain, wanted) in [(&of_table, table), (&of_head, head)] {
                let said = plus_turns(chain, axis, along.into());
                assert!(
                    said.english().starts_with(&format!("plus {axis}: the "))
                        && said.english().ends_with(wanted),
                    "{said}"
                );
            }
        }
    }
}
