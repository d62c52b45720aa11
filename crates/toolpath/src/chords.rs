//! Straight lines that stand for a curve by control points.

use crate::nurbs::{Bezier, MOST_DEGREE};

/// A part of a curve, from where the one before it ended, and the line between its ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Chord {
    /// The end of both, mm.
    pub end_mm: [f64; 3],
    /// The part and the line, each run through from end to end, are nowhere further apart than this, mm.
    pub beside_mm: f64,
}

/// The control points of a part as `(w P, w)`.
type Net = [[f64; 4]; MOST_DEGREE + 1];

/// Control points that go back along the chord by so little go on, mm.
const SLACK_MM: f64 = 1e-9;

/// Of what fits by that rule the next part takes so much: curvature grows on the way.
const STRETCH: f64 = 0.96;

/// No part is shorter in s: of any curve with weights that a control takes it is a point.
const SHORTEST: f64 = 1e-13;

impl Bezier {
    /// Cuts the curve from `start_mm` to `end_mm` into parts for which lines stand within `within_mm`: equation (112).
    ///
    /// `each` is given one after the other, from the start; what it returns ends the work. Where weights or places are beyond
    /// reason a part may be further from its line than that: [`Chord::beside_mm`] says so.
    ///
    /// ```
    /// use toolpath::{Bezier, Chord};
    ///
    /// let curve = Bezier::new(&[[5.0, 10.0, 0.0]], &[1.0; 3]);
    /// let mut lines = 0;
    /// let count = &mut |chord: Chord| -> Result<(), ()> {
    ///     lines += 1;
    ///     (chord.beside_mm <= 0.01).then_some(()).ok_or(())
    /// };
    /// curve.chords(&[0.0; 3], &[10.0, 0.0, 0.0], 0.01, count).unwrap();
    /// assert_eq!(lines, 21);
    /// ```
    ///
    /// # Errors
    /// What `each` returns.
    pub fn chords<E>(
        &self,
        start_mm: &[f64; 3],
        end_mm: &[f64; 3],
        within_mm: f64,
        each: &mut impl FnMut(Chord) -> Result<(), E>,
    ) -> Result<(), E> {
        let net = self.net(start_mm, end_mm);
        if net[..=self.degree()].iter().flatten().any(|number| !number.is_finite()) {
            return each(Chord { end_mm: *end_mm, beside_mm: f64::INFINITY });
        }
        let cut = Cut { degree: self.degree(), net };
        let (mut from_mm, mut s, mut step) = (*start_mm, 0.0, 1.0);
        while s < 1.0 {
            let to = if s + step < 1.0 { s + step } else { 1.0 };
            let part = cut.part(s, to);
            let to_mm = if to < 1.0 { divided(&part[cut.degree]) } else { *end_mm };
            let (beside_mm, goes_on) = cut.beside_mm(&part, &from_mm, &to_mm);
            // How far a smooth curve lies beside its chord goes with the square of its length.
            let fits = if goes_on { STRETCH * (within_mm / beside_mm.max(1e-300)).sqrt() } else { 0.5 };
            if beside_mm <= within_mm || to - s <= SHORTEST {
                each(Chord { end_mm: to_mm, beside_mm })?;
                (from_mm, s) = (to_mm, to);
                step *= fits.clamp(0.5, 4.0);
            } else {
                step = (to - s) * fits.clamp(0.05, 0.9);
            }
        }
        Ok(())
    }

    pub(crate) fn net(&self, start_mm: &[f64; 3], end_mm: &[f64; 3]) -> Net {
        let degree = self.degree();
        let mut net = [[0.0; 4]; MOST_DEGREE + 1];
        for (i, place) in net[..=degree].iter_mut().enumerate() {
            let [x, y, z] = match i {
                0 => *start_mm,
                _ if i == degree => *end_mm,
                _ => self.inner_mm()[i - 1],
            };
            let w = self.weights()[i];
            *place = [w * x, w * y, w * z, w];
        }
        net
    }
}

/// The curve that is cut.
struct Cut {
    degree: usize,
    net: Net,
}

impl Cut {
    /// The control points of the part from s0 to s1: de Casteljau's algorithm, from the whole each time.
    fn part(&self, s0: f64, s1: f64) -> Net {
        let mut net = self.net;
        let mixed = |a: &[f64; 4], b: &[f64; 4], s: f64| std::array::from_fn(|k| (1.0 - s) * a[k] + s * b[k]);
        if s0 > 0.0 {
            // Ends each level at its last place: what lies behind s0.
            for level in 1..=self.degree {
                for i in 0..=self.degree - level {
                    net[i] = mixed(&net[i], &net[i + 1], s0);
                }
            }
        }
        if s1 < 1.0 {
            let s = (s1 - s0) / (1.0 - s0);
            for level in 1..=self.degree {
                for i in (level..=self.degree).rev() {
                    net[i] = mixed(&net[i - 1], &net[i], s);
                }
            }
        }
        net
    }

    /// How far a part lies beside its chord at most, mm, and whether it goes on along it.
    ///
    /// The curve lies in the hull of its control points. Where these go on along the chord, so does the curve (it crosses a
    /// plane no more often than their polygon does), and beside the chord it is at most the share of the inner ones of the
    /// furthest of them. Where they do not, no two places of the hull are further apart than two control points.
    fn beside_mm(&self, net: &Net, start_mm: &[f64; 3], end_mm: &[f64; 3]) -> (f64, bool) {
        let last = self.degree;
        let mut places = [[0.0; 3]; MOST_DEGREE + 1];
        for (i, place) in places[..=last].iter_mut().enumerate() {
            *place = match i {
                0 => *start_mm,
                _ if i == last => *end_mm,
                _ => divided(&net[i]),
            };
        }
        let places = &places[..=last];
        let chord = less(end_mm, start_mm);
        let length_mm = dot(&chord, &chord).sqrt();
        if length_mm > 0.0 {
            let along = chord.map(|mm| mm / length_mm);
            if places.windows(2).all(|leg| dot(&less(&leg[1], &leg[0]), &along) >= -SLACK_MM) {
                let square = |place: &[f64; 3]| {
                    let off = less(place, start_mm);
                    let on = dot(&off, &along);
                    dot(&off, &off) - on * on
                };
                let furthest = places[1..last].iter().map(square).fold(0.0, f64::max).sqrt();
                let slack_mm = SLACK_MM * last as f64;
                return (furthest * self.inner_share(net) + slack_mm, true);
            }
        }
        let apart = |a: &[f64; 3], b: &[f64; 3]| dot(&less(a, b), &less(a, b)).sqrt();
        let pairs = places.iter().enumerate().flat_map(|(i, a)| places[..i].iter().map(move |b| (a, b)));
        (pairs.map(|(a, b)| apart(a, b)).fold(0.0, f64::max), false)
    }

    /// The largest share of a place that inner control points have: `1 - s^n - (1-s)^n` is at most `1 - 2^(1-n)`, and weights
    /// make it more.
    fn inner_share(&self, net: &Net) -> f64 {
        let last = self.degree;
        let ends = 0.5f64.powi(last as i32 - 1);
        let heaviest = net[1..last].iter().map(|place| place[3]).fold(0.0, f64::max);
        let inner = (1.0 - ends) * heaviest;
        inner / (inner + ends * net[0][3].min(net[last][3]))
    }
}

fn divided([x, y, z, w]: &[f64; 4]) -> [f64; 3] {
    [x / w, y / w, z / w]
}

fn less(a: &[f64; 3], b: &[f64; 3]) -> [f64; 3] {
    std::array::from_fn(|i| a[i] - b[i])
}

fn dot(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn chords(curve: &Bezier, start: &[f64; 3], end: &[f64; 3], within: f64) -> Vec<Chord> {
        let mut all = Vec::new();
        let result: Result<(), ()> = curve.chords(start, end, within, &mut |chord| {
            all.push(chord);
            Ok(())
        });
        result.unwrap();
        all
    }

    /// The least s by which the Fréchet distance of two paths, given by many places each, is at most `most`: none where it is
    /// more (Eiter and Mannila 1994, decided row by row).
    fn within(a: &[[f64; 3]], b: &[[f64; 3]], most: f64) -> bool {
        let near = |p: &[f64; 3], q: &[f64; 3]| dot(&less(p, q), &less(p, q)).sqrt() <= most;
        let mut row = vec![false; b.len()];
        for (i, p) in a.iter().enumerate() {
            let mut next = vec![false; b.len()];
            for (j, q) in b.iter().enumerate() {
                let comes = (i == 0 && j == 0)
                    || (i > 0 && row[j])
                    || (j > 0 && next[j - 1])
                    || (i > 0 && j > 0 && row[j - 1]);
                next[j] = comes && near(p, q);
            }
            row = next;
        }
        row[b.len() - 1]
    }

    proptest! {
        #[test]
        fn lines_are_as_near_as_they_say(
            inner in prop::collection::vec(prop::array::uniform3(-10.0f64..10.0), 1..5),
            ends in prop::array::uniform2(prop::array::uniform3(-10.0f64..10.0)),
            weights in prop::array::uniform6(0.05f64..8.0), even: bool, still: bool, within_mm in 0.02f64..2.0,
        ) {
            let mut inner = inner;
            if still {
                // As a drawing program writes a corner: it starts without a direction.
                inner[0] = ends[0];
            }
            let weights = if even { [1.0; 6] } else { weights };
            let curve = Bezier::new(&inner, &weights[..inner.len() + 2]);
            let all = chords(&curve, &ends[0], &ends[1], within_mm);
            prop_assert_eq!(all.last().unwrap().end_mm, ends[1]);
            prop_assert!(all.iter().all(|chord| chord.beside_mm <= within_mm));
            let mut lines = vec![ends[0]];
            for chord in &all {
                let from = *lines.last().unwrap();
                let places = 1.0 + (dot(&less(&chord.end_mm, &from), &less(&chord.end_mm, &from)).sqrt() * 20.0).ceil();
                lines.extend((1..=places as u32).map(|k| {
                    let s = f64::from(k) / places;
                    std::array::from_fn(|i| from[i] + (chord.end_mm[i] - from[i]) * s)
                }));
            }
            // Cut finer than both: a place every 0.05 mm.
            let mut path = vec![ends[0]];
            let result: Result<(), ()> = curve.chords(&ends[0], &ends[1], 1e-4, &mut |chord| {
                let from = *path.last().unwrap();
                let places = 1.0 + (dot(&less(&chord.end_mm, &from), &less(&chord.end_mm, &from)).sqrt() * 20.0).ceil();
                path.extend((1..=places as u32).map(|k| {
                    let s = f64::from(k) / places;
                    std::array::from_fn(|i| from[i] + (chord.end_mm[i] - from[i]) * s)
                }));
                Ok(())
            });
            result.unwrap();
            // And these are places of the curve, by its own formula: each is near one.
            for k in 0..=200 {
                let at = curve.at(&ends[0], &ends[1], f64::from(k) / 200.0);
                let near = path.iter().map(|p| dot(&less(p, &at), &less(p, &at)).sqrt()).fold(f64::MAX, f64::min);
                prop_assert!(near <= 0.03, "{}", near);
            }
            prop_assert!(within(&path, &lines, within_mm + 0.06), "{} lines", all.len());
        }
    }

    #[test]
    fn a_circle_takes_as_many_as_its_sagitta_says() {
        let quarter = Bezier::new(&[[20.0, 20.0, 0.0]], &[1.0, 0.5f64.sqrt(), 1.0]);
        let all = chords(&quarter, &[20.0, 0.0, 0.0], &[0.0, 20.0, 0.0], 0.001);
        // 8 r t for the square of a chord's length: 79 lines would do if each were as long as may be.
        assert!((79..=90).contains(&all.len()), "{}", all.len());
        for pair in all.windows(2) {
            let middle: [f64; 3] = std::array::from_fn(|i| 0.5 * (pair[0].end_mm[i] + pair[1].end_mm[i]));
            let sagitta = 20.0 - dot(&middle, &middle).sqrt();
            assert!(sagitta <= pair[1].beside_mm + 1e-9 && sagitta > 0.3 * pair[1].beside_mm, "{sagitta}");
        }
    }

    #[test]
    fn what_is_beyond_reason_says_so() {
        let far = Bezier::new(&[[f64::MAX, 1.0, 0.0]], &[1.0, 4.0, 1.0]);
        assert_eq!(chords(&far, &[0.0; 3], &[1.0; 3], 0.1)[0].beside_mm, f64::INFINITY);
        let point = Bezier::new(&[[1.0; 3], [1.0; 3]], &[1.0; 4]);
        assert_eq!(chords(&point, &[1.0; 3], &[1.0; 3], 1e-6), [Chord { end_mm: [1.0; 3], beside_mm: 0.0 }]);
    }
}
