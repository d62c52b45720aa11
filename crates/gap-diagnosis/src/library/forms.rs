//! The forms of every effect: textbook first, then bent ones.

use machine_model::effects::{EffectKind, Shape};

use crate::equations::observation::Measurements;
use crate::equations::set_up::{Clamping, frame, instruments};
use crate::equations::term::Term;
use crate::library::candidates::{Candidate, Library, SLOPE, Variant};
use crate::library::sampling::Sampling;
use crate::library::seen::Seen;

/// Places along an axis where damage is looked for; finer ones are proposed by the search.
const LOCAL_PLACES: usize = 14;
/// Times at which a knock is looked for; finer ones are proposed by the search.
const STEP_TIMES: usize = 24;
/// Ways over which a spike at a turning point fades, mm.
const SPIKES_MM: [f64; 5] = [0.75, 1.5, 3.0, 6.0, 12.0];
/// Time constants as shares of the time the measurement took.
const TAU_SHARES: [f64; 6] = [0.03, 0.08, 0.2, 0.5, 1.2, 3.0];

/// Damage at a place is narrower than this share of the axis.
pub(crate) const LOCAL_WIDEST: f64 = 0.3;

impl Library {
    /// Every effect whose columns the rows hold, except those in `without`; `clamping`: what the set-ups of the runs hold.
    pub(crate) fn new(data: &Measurements, without: &[EffectKind], clamping: Clamping) -> Self {
        let seen = Seen::new(data);
        let mut terms = frame(data, clamping);
        let framing = terms.len();
        terms.extend(instruments(data));
        if data.has_lengths() {
            terms.push(Term::BarLength);
        }
        for axis in 0..3 {
            if seen.direction[axis] && seen.unknown_direction[axis] {
                terms.push(Term::UnknownApproach(axis));
            }
        }
        let nuisances = terms.len();
        let untimed = data.rows.iter().all(|row| row.conditions.time_s.is_none());
        let read = if untimed { components_read(data) } else { [false; 3] };
        let mut library = Self { sampling: seen.sampling, terms, framing, nuisances, candidates: Vec::new() };
        for kind in EffectKind::all().into_iter().filter(|k| !without.contains(k)) {
            let mut variants = library.forms(kind, &seen);
            variants.retain(|form| seen.carry(kind, form.columns.len()));
            match kind {
                EffectKind::InstrumentDrift if untimed => variants = library.orders(data, read),
                EffectKind::Step(axis) if untimed => {
                    variants = if read[axis] { library.knocks(data, axis) } else { Vec::new() };
                }
                _ => {}
            }
            if !variants.is_empty() {
                library.candidates.push(Candidate { kind, variants, rejected: 0 });
            }
        }
        library
    }

    fn forms(&mut self, kind: EffectKind, seen: &Seen) -> Vec<Variant> {
        if !seen.shows(kind) {
            return Vec::new();
        }
        let none = Shape::default();
        match kind {
            EffectKind::Scale(_)
            | EffectKind::Squareness(..)
            | EffectKind::ServoMismatch(..)
            | EffectKind::Rotary { .. }
            | EffectKind::SpindleTilt(_) => self.selections(kind, none, &[&[0]]),
            EffectKind::Backlash(a) | EffectKind::LostMotion { axis: a, .. } => {
                self.selections(kind, seen.interval(a), &[&[0], &[0, 1], &[0, 1, 2, 3]])
            }
            EffectKind::Thermal(_) => self.selections(kind, none, &[&[0, 1], &[0], &[0, 1, 2]]),
            EffectKind::Warmup(_) => self.warmup(kind, seen),
            EffectKind::Positioning(a) | EffectKind::Straightness { axis: a, .. } => {
                self.curve(kind, a, seen)
            }
            EffectKind::Angular { axis: a, about } => self.angle(kind, a, about, seen),
            EffectKind::Sag(a) => self.sag(kind, a, seen),
            // With two loads a line and a parabola can be any two values: a bend needs three. A lag bent over
            // the feed could be a backlash, so lags stay straight.
            EffectKind::Load(_) => {
                self.selections(kind, none, if seen.loads > 2 { &[&[0], &[0, 1]] } else { &[&[0]] })
            }
            EffectKind::ServoLag(_) => self.selections(kind, none, &[&[0], &[1]]),
            EffectKind::Eccentricity(_) => self.selections(kind, none, &[&[0, 1], &[0, 1, 2, 3, 4, 5]]),
            EffectKind::ProbeLobing => self.selections(kind, none, &[&[0, 1], &[0, 1, 4], &[0, 1, 2, 3, 4]]),
            EffectKind::InstrumentDrift => {
                let lists: [&[usize]; 8] =
                    [&[0, 1, 2], &[0], &[1], &[2], &[0, 3], &[1, 4], &[2, 5], &[0, 1, 2, 3, 4, 5]];
                self.selections(kind, none, &lists)
            }
            EffectKind::Step(_) => self.steps(kind, seen),
            EffectKind::Local(a) => self.places(kind, &seen.sampling[a]),
            EffectKind::Spike(a) => SPIKES_MM
                .into_iter()
                .filter(|width| *width >= seen.turns_mm[a])
                .flat_map(|width_mm| self.selections(kind, Shape { width_mm, ..Shape::default() }, &[&[0]]))
                .collect(),
            // With one feed on one radius it is a scale of all axes that move.
            EffectKind::Contraction => {
                let mut forms =
                    self.selections(kind, none, &[&[0], &[1], &[2], &[3], &[1, 2], &[1, 3], &[2, 3]]);
                forms.iter_mut().for_each(|form| {
                    form.enriched = form.columns.len() > 1;
                    form.only_rival = !seen.accelerations;
                });
                forms
            }
            EffectKind::Tracker(2 | 3) => self.selections(kind, none, &[&[0, 1]]),
            EffectKind::Tracker(_) => self.selections(kind, none, &[&[0]]),
            // The search proposes them.
            EffectKind::Pitch(_) | EffectKind::Joint(_) => Vec::new(),
        }
    }

    /// A drift in the order of the rows: even through all runs; even, or with a time constant, anew in each, as where
    /// each begins cold. On places that are passed once the order is the place, but where one run goes over an area.
    fn orders(&mut self, data: &Measurements, read: [bool; 3]) -> Vec<Variant> {
        let again = |anew: bool| data.comes_back(|row| if anew { row.run } else { 0 });
        let passed_again =
            |anew: &bool| data.is_followed() && (again(*anew) || *anew && data.runs.len() == 1);
        let mut forms = Vec::new();
        for anew in [false, true].into_iter().filter(passed_again) {
            let grown = if anew { &TAU_SHARES[..] } else { &[] };
            for component in (0..3).filter(|component| read[*component]) {
                for tau in [f64::INFINITY].iter().chain(grown) {
                    self.terms.push(Term::Order { component, anew, tau: *tau });
                    forms.push(Variant::textbook(vec![self.terms.len() - 1]));
                }
            }
        }
        forms
    }

    /// A knock between two rows, where the order of the rows is no place.
    fn knocks(&mut self, data: &Measurements, component: usize) -> Vec<Variant> {
        if !data.is_followed() || !data.comes_back(|_| 0) {
            return Vec::new();
        }
        let at = |k: usize| k as f64 / (STEP_TIMES + 1) as f64;
        let columns = (1..=STEP_TIMES).map(|k| self.knock_column(component, at(k)));
        columns.map(|column| Variant::textbook(vec![column])).collect()
    }

    fn knock_column(&mut self, component: usize, from: f64) -> usize {
        let knock = Term::Knock { component, from };
        self.terms.iter().position(|term| *term == knock).unwrap_or_else(|| {
            self.terms.push(knock);
            self.terms.len() - 1
        })
    }

    /// The column of a knock at a moment: a time, or a share of the file where knocks are known by the order of the
    /// rows; `None` where there can be none.
    pub(crate) fn knock(&mut self, axis: usize, moment: f64) -> Option<Vec<usize>> {
        let kind = EffectKind::Step(axis);
        let known = self.candidates.iter().find(|candidate| candidate.kind == kind)?;
        match self.terms[*known.variants.first()?.columns.first()?] {
            Term::Knock { .. } => Some(vec![self.knock_column(axis, moment)]),
            _ => Some(self.add_columns(kind, Shape { time_s: moment, ..Shape::default() }, &[0])),
        }
    }

    /// A curve along an axis.
    fn curve(&mut self, kind: EffectKind, a: usize, seen: &Seen) -> Vec<Variant> {
        let lists: [&[usize]; 5] = [&[0, 1], &[0], &[1], &[0, 1, 2, 3], &[0, 1, 2, 3, 4, 5]];
        // A polynomial with nearly as many terms as places is a guess between them.
        let lists: Vec<&[usize]> = lists
            .into_iter()
            .filter(|l| l.len() <= 2 || 10 * (l.len() + 2) <= 7 * seen.sampling[a].places)
            .collect();
        let mut forms = self.selections(kind, seen.interval(a), &lists);
        // Any curve is one; only beyond the fifth order is it bent so that it could be anything.
        forms.iter_mut().for_each(|f| f.enriched = f.columns.len() > 4);
        forms.extend(self.sloping(kind, a, seen));
        forms
    }

    /// A curve with its slope: of positions, which is a scale, and of any on rows where rotary axes turn.
    ///
    /// With its slope a curve of positions stands for both in comparison with other effects, an angle of the carriage
    /// first of all. Across an axis a slope is a squareness or the measuring frame's. A frame turns the tool as well;
    /// where rotary axes turn it by themselves that shows, and only a squareness is one effect of its own: there the
    /// others may be named with their slope, for without these forms a droop, damage or high orders take it for the
    /// curve it belongs to.
    fn sloping(&mut self, kind: EffectKind, a: usize, seen: &Seen) -> Vec<Variant> {
        if seen.rotary == [false; 3] && !matches!(kind, EffectKind::Positioning(_)) {
            return Vec::new();
        }
        // Three numbers at least: a slope and a bow would pass for a lone squareness that noise bends a little.
        let lists: [&[usize]; 2] = [&[0, 1, SLOPE], &[0, 1, 2, 3, SLOPE]];
        let lists: Vec<&[usize]> =
            lists.into_iter().filter(|l| 10 * (l.len() + 1) <= 7 * seen.sampling[a].places).collect();
        let mut forms = self.selections(kind, seen.interval(a), &lists);
        let owned = !matches!(kind, EffectKind::Straightness { direction, axis } if direction > axis);
        forms.iter_mut().for_each(|form| (form.enriched, form.only_rival) = (true, owned));
        forms
    }

    /// An angle along an axis.
    fn angle(&mut self, kind: EffectKind, a: usize, about: usize, seen: &Seen) -> Vec<Variant> {
        let lists: [&[usize]; 6] = [&[0, 1], &[0], &[1], &[0, 1, 2], &[0, 1, 2, 3, 4], &[1, 2]];
        let lists: Vec<&[usize]> = lists
            .into_iter()
            .filter(|l| l.len() <= 2 || 10 * (l.len() + 1) <= 7 * seen.sampling[a].places)
            .collect();
        let mut forms = self.selections(kind, seen.interval(a), &lists);
        forms.iter_mut().for_each(|form| form.only_rival = seen.one_lever[a][about]);
        forms
    }

    /// A droop along an axis.
    fn sag(&mut self, kind: EffectKind, a: usize, seen: &Seen) -> Vec<Variant> {
        // The overhang begins where the ram leaves its support: at the end of travel, before or behind.
        let (low, high) = seen.sampling[a].range_mm;
        [0.0, -1.0, -0.4, 0.2, 0.4, 0.6]
            .into_iter()
            .flat_map(|share| {
                let from_mm = low + share * (high - low);
                let shape = Shape { from_mm, to_mm: high, ..Shape::default() };
                let lists: &[&[usize]] = if share == 0.0 { &[&[0], &[1], &[2]] } else { &[&[0], &[1]] };
                let mut forms = self.selections(kind, shape, lists);
                forms.iter_mut().for_each(|f| {
                    f.enriched = share != 0.0;
                    // On a circle a droop is a straightness.
                    f.only_rival = seen.lengths;
                });
                forms
            })
            .collect()
    }

    fn warmup(&mut self, kind: EffectKind, seen: &Seen) -> Vec<Variant> {
        let Some((start, end)) = seen.time else { return Vec::new() };
        let taus = TAU_SHARES.map(|share| share * (end - start));
        let columns: Vec<usize> = taus
            .iter()
            .flat_map(|tau| {
                self.add_columns(kind, Shape { tau_s: *tau, tau2_s: *tau, ..Shape::default() }, &[0])
            })
            .collect();
        let single = columns.iter().map(|c| Variant::textbook(vec![*c]));
        let double = columns.iter().zip(columns.iter().skip(2));
        let double = double.map(|(a, b)| Variant { enriched: true, ..Variant::textbook(vec![*a, *b]) });
        single.chain(double).collect()
    }

    fn steps(&mut self, kind: EffectKind, seen: &Seen) -> Vec<Variant> {
        let Some((start, end)) = seen.time else { return Vec::new() };
        (1..=STEP_TIMES)
            .map(|k| {
                let time_s = start + (end - start) * k as f64 / (STEP_TIMES + 1) as f64;
                Variant::textbook(self.add_columns(kind, Shape { time_s, ..Shape::default() }, &[0]))
            })
            .collect()
    }

    fn places(&mut self, kind: EffectKind, sampling: &Sampling) -> Vec<Variant> {
        let (low, high) = sampling.range_mm;
        let width_mm = (2.0 * (high - low) / LOCAL_PLACES as f64).max(sampling.narrowest_mm);
        if width_mm > LOCAL_WIDEST * (high - low) {
            return Vec::new();
        }
        (0..=LOCAL_PLACES)
            .flat_map(|k| {
                let centre_mm = low + (high - low) * k as f64 / LOCAL_PLACES as f64;
                self.place(kind, centre_mm, width_mm)
            })
            .collect()
    }

    /// Rails that do not meet at a place: sideways in one direction or both.
    pub(crate) fn join(&mut self, kind: EffectKind, centre_mm: f64, width_mm: f64) -> Vec<Variant> {
        let EffectKind::Joint(axis) = kind else { return Vec::new() };
        let sideways: Vec<usize> = (0..3).filter(|d| *d != axis).collect();
        let shape = Shape { centre_mm, width_mm, ..Shape::default() };
        Variant::each_and_all(self.add_columns(kind, shape, &sideways))
    }

    /// Damage at one place: along one direction or all three.
    pub(crate) fn place(&mut self, kind: EffectKind, centre_mm: f64, width_mm: f64) -> Vec<Variant> {
        let shape = Shape { centre_mm, width_mm, ..Shape::default() };
        Variant::each_and_all(self.add_columns(kind, shape, &[0, 1, 2]))
    }

    /// Forms of a pitch error with this period: textbook, with harmonics, with a slope of the amplitude. A harmonic
    /// that the places are too coarse for is not asked about; where the period itself is, the textbook form and the
    /// one with the harmonic that most screws have stay rivals.
    pub(crate) fn pitch(&mut self, axis: usize, pitch_mm: f64) -> Vec<Variant> {
        let sampling = self.sampling[axis];
        let (from_mm, to_mm) = sampling.range_mm;
        let shape = Shape { pitch_mm, from_mm, to_mm, ..Shape::default() };
        let only_rival = sampling.is_coarse(pitch_mm);
        let lists: [(f64, &[usize]); 5] = [
            (1.0, &[0, 1]),
            (2.0, &[0, 1, 2, 3]),
            (1.0, &[0, 1, 6, 7]),
            (3.0, &[0, 1, 2, 3, 4, 5]),
            (3.0, &[0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11]),
        ];
        let shown = |(harmonic, list): &(f64, &[usize])| {
            list.len() == 2
                || ((only_rival || !sampling.is_coarse(pitch_mm / harmonic))
                    && 2.0 * list.len() as f64 <= sampling.effective)
        };
        let lists: Vec<&[usize]> = lists.into_iter().filter(shown).map(|(_, list)| list).collect();
        let mut forms = self.selections(EffectKind::Pitch(axis), shape, &lists);
        if only_rival {
            forms.truncate(2);
        }
        forms.iter_mut().for_each(|form| form.only_rival = only_rival);
        forms
    }
}

/// X, Y, Z that rows read as such.
fn components_read(data: &Measurements) -> [bool; 3] {
    let scalars = data.scalars(None);
    [0, 1, 2].map(|component| scalars.iter().any(|scalar| scalar.class == component))
}
