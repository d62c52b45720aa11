//! Fewer places, by a bound.
//!
//! The method of Ramer (1972) and Douglas and Peucker (1973): of a stretch the ends are kept, and the place that lies
//! farthest from what is drawn between them, if that is farther than the bound; then the same for both halves. Here far is
//! a place in space and every displacement, each by its own bound.

use super::scene::{Place, Scene};

/// No more places are drawn: what a slow computer turns without a jerk.
const MOST_DRAWN: usize = 30_000;
/// Nor more than so many bytes of their numbers, of which a place has so many besides those of its displacements, and each
/// of these so many more (it lies along one axis mostly).
const MOST_BYTES: usize = 1_200_000;
const BYTES_OF_A_PLACE: usize = 10;
const BYTES_OF_A_DISPLACEMENT: usize = 2;
/// So many times as many are held before they are thinned further.
const HELD: usize = 8;
/// Within a motion places are left out that make no difference to anybody, µm.
const WITHIN_MOTIONS: Bounds = Bounds { path: 0.5, displaced: 0.01 };
/// Motions are left out by bounds that are these parts of the path's size, the finest and the coarsest, in so many steps.
const FINEST: f64 = 1.0 / 40_000.0;
const COARSEST: f64 = 1.0 / 400.0;
const STEPS: u32 = 8;
/// The largest displacement is drawn about as large as this part of the path: what is small in space is as small there.
const DRAWN_AS: f64 = 1.0 / 8.0;

/// Even by the coarsest bound more places are left than a page can hold.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TooLarge {
    /// Places read so far.
    pub places: usize,
    /// Places left, and how many a page can hold.
    pub left: usize,
    /// How many a page can hold.
    pub most: usize,
    /// The bound, µm.
    pub path_bound_um: f64,
}

/// Takes places in order and keeps those that have to be drawn.
#[derive(Clone, Debug)]
pub struct Thinning {
    /// Size of the path, µm, and the largest displacement.
    size_um: f64,
    largest_um: f64,
    most: usize,
    kept: Vec<Place>,
    /// The motion under way.
    motion: Vec<Place>,
    of: usize,
    /// So many of those kept are thinned by the bound of this step.
    settled: usize,
    step: u32,
    /// What all steps together have left out.
    bounds_um: Option<Bounds>,
}

/// How far off a place, and a displacement, may be, µm.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Bounds {
    path: f64,
    displaced: f64,
}

impl Thinning {
    /// Of a path about so large, mm, with displacements of about that size, µm, so many at each place.
    #[must_use]
    pub fn new(size_mm: f64, largest_um: f64, displacements: usize) -> Self {
        let bytes = BYTES_OF_A_PLACE + displacements * BYTES_OF_A_DISPLACEMENT;
        Self {
            size_um: size_mm * 1e3,
            largest_um,
            most: MOST_DRAWN.min(MOST_BYTES / bytes),
            kept: Vec::new(),
            motion: Vec::new(),
            of: 0,
            settled: 0,
            step: 0,
            bounds_um: None,
        }
    }

    /// The next place.
    ///
    /// # Errors
    /// [`TooLarge`]
    pub fn push(&mut self, place: Place) -> Result<(), TooLarge> {
        self.of += 1;
        if place.begins {
            self.end_motion();
        }
        let ends = place.ends;
        self.motion.push(place);
        if ends {
            self.end_motion();
        }
        if self.kept.len() > HELD * self.most { self.reduce_to(HELD / 2 * self.most) } else { Ok(()) }
    }

    /// What is drawn.
    ///
    /// # Errors
    /// [`TooLarge`]
    pub fn finish(mut self) -> Result<Scene, TooLarge> {
        self.end_motion();
        self.settle();
        self.fit()?;
        let Bounds { path, displaced } = self.bounds_um.unwrap_or_default();
        Ok(Scene {
            causes: Vec::new(),
            places: self.kept,
            of: self.of,
            path_bound_um: path,
            displaced_bound_um: displaced,
            remainder_um: 0.0,
        })
    }

    /// Places within a motion; its ends are kept while there is room.
    fn end_motion(&mut self) {
        let motion = std::mem::take(&mut self.motion);
        if motion.len() > 2 {
            self.bounds_um.get_or_insert(WITHIN_MOTIONS);
        }
        // The motion before ends where this one starts: it is part of the stretch.
        let start = motion.first().filter(|first| !first.begins).and_then(|_| self.kept.pop());
        let whole: Vec<Place> = start.into_iter().chain(motion).collect();
        let before = self.kept.len();
        self.kept.extend(thinned(whole, WITHIN_MOTIONS));
        self.settled = self.settled.min(before);
    }

    /// Bounds between the finest (0) and the coarsest (1).
    fn bounds(&self, share: f64) -> Bounds {
        let part = FINEST * units::math::powf(COARSEST / FINEST, share);
        Bounds { path: part * self.size_um, displaced: part / DRAWN_AS * self.largest_um }
    }

    fn bounds_of_step(&self) -> Bounds {
        self.bounds(f64::from(self.step) / f64::from(STEPS))
    }

    /// What has come since the last step is thinned by it as well.
    fn settle(&mut self) {
        if self.step > 0 && self.settled < self.kept.len() {
            let new = self.kept.split_off(self.settled.saturating_sub(1));
            self.kept.extend(thinned(new, self.bounds_of_step()));
        }
        self.settled = self.kept.len();
    }

    /// Step by step coarser, while a path comes that is longer than can be held.
    fn reduce_to(&mut self, most: usize) -> Result<(), TooLarge> {
        self.settle();
        while self.kept.len() > most {
            if self.step == STEPS {
                return Err(self.too_large(self.kept.len(), Bounds::default()));
            }
            // Far from the goal every other step will do.
            let far = self.kept.len() > 4 * most;
            self.step = (self.step + if far { 2 } else { 1 }).min(STEPS);
            self.thin_by(self.bounds_of_step());
        }
        Ok(())
    }

    /// The whole path at once, by the finest bounds that leave no more than a page can hold.
    fn fit(&mut self) -> Result<(), TooLarge> {
        /// Halvings of the range of bounds.
        const ROUNDS: u32 = 7;
        if self.kept.len() <= self.most {
            return Ok(());
        }
        let left = |bounds| needed(&self.kept, bounds).into_iter().filter(|needed| *needed).count();
        let coarsest = left(self.bounds(1.0));
        if coarsest > self.most {
            return Err(self.too_large(coarsest, self.bounds(1.0)));
        }
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..ROUNDS {
            let middle = 0.5 * (low + high);
            if left(self.bounds(middle)) > self.most { low = middle } else { high = middle }
        }
        self.thin_by(self.bounds(high));
        Ok(())
    }

    /// What is left out lies off what was left before, and that off the path: bounds add up.
    fn thin_by(&mut self, added: Bounds) {
        let bounds = self.bounds_um.get_or_insert_default();
        *bounds = Bounds { path: bounds.path + added.path, displaced: bounds.displaced + added.displaced };
        self.kept = thinned(std::mem::take(&mut self.kept), added);
        self.settled = self.kept.len();
    }

    fn too_large(&self, left: usize, added: Bounds) -> TooLarge {
        let path_bound_um = self.bounds_um.unwrap_or_default().path + added.path;
        TooLarge { places: self.of, left, most: self.most, path_bound_um }
    }
}

/// Those places that have to be kept.
fn thinned(mut places: Vec<Place>, bounds: Bounds) -> Vec<Place> {
    let mut needed = needed(&places, bounds).into_iter();
    places.retain(|_| needed.next() == Some(true));
    places
}

/// Which places have to be kept: both ends of every stretch, and what is far from the line between those kept.
///
/// A stretch has no more than so many places: a path that goes to and fro costs the square of that.
fn needed(places: &[Place], bounds: Bounds) -> Vec<bool> {
    const LONGEST: usize = 256;
    let mut needed = vec![false; places.len()];
    let mut from = 0;
    while from < places.len() {
        let most = places.len().min(from + LONGEST);
        let to = (from + 1..most).find(|next| places[*next].begins).unwrap_or(most) - 1;
        (needed[from], needed[to]) = (true, true);
        let mut open = vec![(from, to)];
        while let Some((from, to)) = open.pop() {
            let far = |k: usize| distance(&places[from], &places[to], &places[k], bounds);
            let farthest = (from + 1..to).map(|k| (far(k), k)).max_by(|a, b| a.0.total_cmp(&b.0));
            if let Some((distance, middle)) = farthest
                && distance > 1.0
            {
                needed[middle] = true;
                open.extend([(from, middle), (middle, to)]);
            }
        }
        // The next stretch begins where this one ends, if it goes on.
        let goes_on = places.get(to + 1).is_some_and(|next| !next.begins) && to > from;
        from = if goes_on { to } else { to + 1 };
    }
    needed
}

/// How far a place is from what is drawn between two others, as parts of the bounds.
fn distance(from: &Place, to: &Place, place: &Place, bounds: Bounds) -> f64 {
    if place.unknown_after != from.unknown_after || place.unknown_after != to.unknown_after {
        return f64::INFINITY;
    }
    let along = [0, 1, 2].map(|axis| to.at_mm[axis] - from.at_mm[axis]);
    let here = [0, 1, 2].map(|axis| place.at_mm[axis] - from.at_mm[axis]);
    let dot = |a: &[f64; 3], b: &[f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let square = dot(&along, &along);
    let s = if square > 0.0 { (dot(&here, &along) / square).clamp(0.0, 1.0) } else { 0.0 };
    let beside = [0, 1, 2].map(|axis| here[axis] - s * along[axis]);
    let path = 1e3 * dot(&beside, &beside).sqrt() / bounds.path;
    let displaced = place.displaced_um.iter().zip(from.displaced_um.iter().zip(&to.displaced_um));
    displaced.fold(path, |far, (here, (from, to))| {
        let off = [0, 1, 2].map(|axis| {
            let [from, to, here] = [from[axis], to[axis], here[axis]].map(f64::from);
            here - (from + s * (to - from))
        });
        far.max(dot(&off, &off).sqrt() / bounds.displaced)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn place(at_mm: [f64; 3], um: f32, line: u64) -> Place {
        let displaced_um = vec![[um, 0.0, 0.0], [0.0; 3]];
        Place {
            at_mm,
            line,
            begins: line == 1,
            ends: true,
            off_um: [um, 0.0],
            unknown_after: false,
            displaced_um,
        }
    }

    fn of(places: &[Place], size_mm: f64, largest_um: f64) -> Result<Scene, TooLarge> {
        let mut thinning = Thinning::new(size_mm, largest_um, 2);
        for place in places {
            thinning.push(place.clone())?;
        }
        thinning.finish()
    }

    #[test]
    fn few_places_are_all_drawn() {
        let places: Vec<Place> = (1..1000).map(|k| place([k as f64, 0.0, 0.0], 0.0, k)).collect();
        let scene = of(&places, 1000.0, 1.0).unwrap();
        assert_eq!(scene.places, places);
        assert_eq!((scene.path_bound_um, scene.displaced_bound_um), (0.0, 0.0));
    }

    /// A spiral whose error swings: every place that was left out lies within the bounds of what is drawn.
    #[test]
    fn what_is_left_out_lies_within_the_bounds() {
        let at = |k: u64| {
            let angle = k as f64 * 0.01;
            let (sin, cos) = units::math::sin_cos(angle);
            let um = 20.0 * units::math::sin_cos(angle * 0.37).0;
            place([(10.0 + angle * 0.05) * cos, (10.0 + angle * 0.05) * sin, 0.0], um as f32, k)
        };
        let places: Vec<Place> = (1..400_000).map(at).collect();
        let scene = of(&places, 400.0, 20.0).unwrap();
        assert!((1000..=MOST_DRAWN).contains(&scene.places.len()), "{}", scene.places.len());
        assert!(scene.path_bound_um > 0.0 && scene.path_bound_um < 2000.0, "{}", scene.path_bound_um);
        let bounds = Bounds { path: scene.path_bound_um, displaced: scene.displaced_bound_um };
        for pair in scene.places.windows(2) {
            let [from, to] = pair else { unreachable!() };
            for place in &places[from.line as usize..to.line as usize - 1] {
                let far = distance(from, to, place, bounds);
                assert!(far <= 1.0 + 1e-9, "line {}: {far}", place.line);
            }
        }
    }

    #[test]
    fn what_cannot_be_thinned_is_refused() {
        // To and fro through a cube, never twice the same way.
        let at = |k: u64| [0.618_034, 0.754_877, 0.569_84].map(|step| 100.0 * (k as f64 * step).fract());
        let places: Vec<Place> = (1..100_000).map(|k| place(at(k), 0.0, k)).collect();
        let refused = of(&places, 173.0, 1.0).map(|scene| scene.places.len()).unwrap_err();
        assert_eq!((refused.most, refused.places), (MOST_DRAWN, 99_999));
        assert!(refused.left > 80_000 && refused.path_bound_um > 350.0, "{refused:?}");
    }
}
