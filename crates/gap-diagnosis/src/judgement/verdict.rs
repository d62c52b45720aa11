//! From figures to one word.

use crate::judgement::answer::{Verdict, WorseRun};

/// More than this share of the reducible gap left: the causes named do not explain it.
pub(crate) const PHI_PARTIAL: f64 = 0.05;
/// Lack of fit counts below this probability.
pub(crate) const LACK_OF_FIT: f64 = 1e-3;
/// The best absorber must explain this share, else it is not worth calling the gap partly explained.
pub(crate) const PHI_UNKNOWN: f64 = 0.5;
/// Stated and observed noise may differ by this factor.
pub(crate) const NOISE_FACTOR: f64 = 1.6;

/// What the verdict depends on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Evidence {
    /// Equations minus set-up.
    pub degrees: f64,
    /// One run alone, and no line that comes back to its places.
    pub one_run: bool,
    /// Effects that the design can show.
    pub visible: usize,
    /// Causes named.
    pub causes: usize,
    /// Causes that are faults of the instrument.
    pub instrument_causes: usize,
    /// Any cause has rivals.
    pub ambiguous: bool,
    /// Share of the reducible gap left.
    pub phi: f64,
    /// Lack of fit.
    pub lack_of_fit_p: f64,
    /// Residual noise over stated noise, where stated.
    pub noise_ratio: Option<f64>,
    /// Repeats of one command differ by more than neighbouring readings do.
    pub slow: bool,
    /// The rows scatter by more than the noise that was found, or that what comes back leaves room for.
    pub exceeds: bool,
    /// Nothing says how much of the scatter is noise.
    pub guessed: bool,
    /// The causes take off less than [`WORTH_NAMING`] of the gap's RMS.
    pub trifling: bool,
    /// The causes cancel each other: the first of them alone leaves more than there was.
    pub cancels: bool,
    /// Nothing may be written of the causes: nowhere is it sure that a correction does no harm.
    pub risks: bool,
    /// What rows that no fit has seen say.
    pub unseen: Option<Unseen>,
}

/// Forecast and outcome on rows that no fit has seen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Unseen {
    /// RMS without the causes, in units of what noise alone leaves there.
    pub before: f64,
    /// RMS with them, in the same units.
    pub after: f64,
    /// Low end and middle of the forecast shrinkage.
    pub promised: (f64, f64),
    /// Standard error of the achieved shrinkage by the number of rows alone.
    pub error: f64,
    /// Standard error of the RMS without the causes where it is noise, in the same units.
    pub chance: f64,
    /// Searched by themselves, with a fit of their own, these rows show a gap; asked only where the others show none.
    pub alone: bool,
    /// The run that the causes make worse by most, where one is made worse by more than chance.
    pub worse: Option<WorseRun>,
}

impl Evidence {
    /// Rows that no fit has seen keep the forecast of causes beside which something is left.
    pub(crate) fn confirmed(&self) -> bool {
        on_the_rows(self) == Verdict::Partial && self.unseen.is_some_and(|u| !u.refutes() && u.keeps())
    }
}

impl Unseen {
    pub(crate) fn achieved(&self) -> f64 {
        if self.before > 0.0 { 1.0 - self.after / self.before } else { 0.0 }
    }

    /// The forecast does not hold, or a run speaks against the causes that the others hide.
    pub(crate) fn refutes(&self) -> bool {
        self.falls_short() || self.worse.is_some()
    }

    /// The middle of the forecast comes true but for chance: an interval that holds anything proves nothing.
    fn keeps(&self) -> bool {
        self.achieved() > SHORT && self.promised.1 - self.achieved() <= f64::max(SHORT, 2.0 * self.error)
    }

    /// The forecast does not hold: less than the low end of its interval, by more than chance, and what is left is no
    /// noise, or hardly anything of it came true.
    pub(crate) fn falls_short(&self) -> bool {
        let short = self.promised.0 - self.achieved();
        let little = self.achieved() < LITTLE * self.promised.1;
        short > f64::max(SHORT, 2.0 * self.error) && (self.after > NOISE_LEFT || little)
    }

    /// A gap where nothing was named.
    pub(crate) fn shows_a_gap(&self) -> bool {
        self.alone
            || self.before > UNSEEN_GAP
            || self.before > 1.0 + f64::max(OTHER_NOISE, NO_CHANCE * self.chance)
    }

    /// A forecast that does not hold, and of which hardly anything came true, where noise is not all that is left.
    fn contradicts(&self) -> bool {
        self.falls_short() && self.after > NOISE_LEFT && self.achieved() < LITTLE * self.promised.1
    }
}

/// Hardly anything of a forecast.
const LITTLE: f64 = 0.25;
/// A forecast may miss the low end of its interval by so much, as a share of the gap.
const SHORT: f64 = 0.05;
/// Up to this factor above the noise, what is left on unseen rows is noise: tails and blunders among them are not left out.
const NOISE_LEFT: f64 = 1.6;
/// An unseen gap of so many times the noise is one, whatever the rows of the fit say. Nobody calls twice the noise agreement,
/// and with the limit there one gap in ten of about that size passed by chance.
const UNSEEN_GAP: f64 = 1.5;
/// Below that, rows enough must say so: noise of another day may be so much larger …
const OTHER_NOISE: f64 = 0.25;
/// … and chance makes no more than so many standard errors.
const NO_CHANCE: f64 = 5.0;
/// Beside structure without a name, a cause that takes off less than this share of the RMS is none that anyone acts on.
pub(crate) const WORTH_NAMING: f64 = 0.1;

/// The verdict, by the first rule that holds:
///
/// 1. UNDERPOWERED: fewer than 12 equations beside the set-up, one run that is no line passed again (set-up and
///    machine are the same then), or a design that shows no effect of the library.
/// 2. Nothing named: UNKNOWN where more than [`PHI_PARTIAL`] of the gap is structure by the lack-of-fit test, UNDERPOWERED
///    where nothing says how much of the scatter is noise, NOISE MODEL
///    SUSPECT where the scatter is not what the file states by more than [`NOISE_FACTOR`], or exceeds the noise that was found
///    by as much (few readings may prove no structure, and are no all-clear either), else NO GAP.
/// 3. Something named and structure left: UNKNOWN where more than [`PHI_UNKNOWN`] is left, else PARTIAL. A share alone
///    is not enough: a small gap leaves a large share of noise; a test alone is not enough: with many rows a nanometre
///    is significant.
/// 4. AMBIGUOUS where any cause has rivals; this stands before the next rule, since a drift of the instrument that a warm-up of
///    the machine explains as well is not known to be the instrument's.
/// 5. PARTIAL where nothing may be written of the causes: NAMED asks to act on them.
/// 6. NOISE MODEL SUSPECT where every cause is a fault of the instrument, else NAMED.
///
/// Causes that cancel each other explain nothing, however well they fit: UNKNOWN.
///
/// What rows that no fit has seen say comes last and weighs most: a forecast they refute is PARTIAL, UNKNOWN where they
/// contradict it, and NO GAP is UNKNOWN where their gap is above [`UNSEEN_GAP`] times the noise, above what noise and
/// chance make of so many rows, or where a search among these rows alone finds one.
pub(crate) fn verdict(e: &Evidence) -> Verdict {
    let seen = on_the_rows(e);
    let Some(unseen) = e.unseen else { return seen };
    match seen {
        Verdict::NoGap | Verdict::NoiseModelSuspect if e.causes == 0 && unseen.shows_a_gap() => {
            Verdict::Unknown
        }
        Verdict::Named | Verdict::Ambiguous | Verdict::NoiseModelSuspect | Verdict::Partial
            if e.causes > 0 && unseen.contradicts() =>
        {
            Verdict::Unknown
        }
        Verdict::Named | Verdict::Ambiguous | Verdict::NoiseModelSuspect
            if e.causes > 0 && unseen.refutes() =>
        {
            Verdict::Partial
        }
        _ => seen,
    }
}

/// The verdict of the rows that were fitted.
fn on_the_rows(e: &Evidence) -> Verdict {
    if e.degrees < 12.0 || e.one_run || e.visible == 0 {
        return Verdict::Underpowered;
    }
    let structured = e.phi > PHI_PARTIAL && e.lack_of_fit_p < LACK_OF_FIT;
    // Where nothing says how much of what a cause leaves is noise, it is no less than all.
    let structured = structured || (e.phi > PHI_PARTIAL && e.guessed && e.causes > 0);
    if e.causes == 0 {
        if structured {
            return Verdict::Unknown;
        }
        if e.guessed {
            return Verdict::Underpowered;
        }
        let suspect = e.noise_ratio.is_some_and(|r| !(1.0 / NOISE_FACTOR..=NOISE_FACTOR).contains(&r));
        return if suspect || e.slow || e.exceeds { Verdict::NoiseModelSuspect } else { Verdict::NoGap };
    }
    if e.cancels {
        return Verdict::Unknown;
    }
    if structured {
        return if e.phi > PHI_UNKNOWN || e.trifling { Verdict::Unknown } else { Verdict::Partial };
    }
    if e.ambiguous {
        return Verdict::Ambiguous;
    }
    if e.risks {
        return Verdict::Partial;
    }
    if e.instrument_causes == e.causes { Verdict::NoiseModelSuspect } else { Verdict::Named }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CLEAR: Evidence = Evidence {
        degrees: 900.0,
        one_run: false,
        visible: 40,
        causes: 1,
        instrument_causes: 0,
        ambiguous: false,
        phi: 0.01,
        lack_of_fit_p: 0.4,
        noise_ratio: None,
        slow: false,
        exceeds: false,
        guessed: false,
        trifling: false,
        cancels: false,
        risks: false,
        unseen: None,
    };

    #[test]
    fn one_rule_after_the_other() {
        let none = Evidence { causes: 0, ..CLEAR };
        let left = Evidence { phi: 0.2, lack_of_fit_p: 1e-6, ..CLEAR };
        let cases = [
            (CLEAR, Verdict::Named),
            (Evidence { degrees: 11.0, ..CLEAR }, Verdict::Underpowered),
            (Evidence { one_run: true, ..CLEAR }, Verdict::Underpowered),
            (Evidence { visible: 0, ..CLEAR }, Verdict::Underpowered),
            (none, Verdict::NoGap),
            (Evidence { phi: 0.2, lack_of_fit_p: 1e-6, ..none }, Verdict::Unknown),
            (Evidence { noise_ratio: Some(2.0), ..none }, Verdict::NoiseModelSuspect),
            (Evidence { noise_ratio: Some(1.5), ..none }, Verdict::NoGap),
            (left, Verdict::Partial),
            (Evidence { phi: 0.6, ..left }, Verdict::Unknown),
            // A share left that noise explains, and a lack of fit that is no share, are neither.
            (Evidence { lack_of_fit_p: 0.4, ..left }, Verdict::Named),
            (Evidence { phi: 0.01, ..left }, Verdict::Named),
            (Evidence { ambiguous: true, ..CLEAR }, Verdict::Ambiguous),
            // A fault of the instrument that a machine could have as well is a set, not a verdict on the instrument.
            (Evidence { ambiguous: true, instrument_causes: 1, ..CLEAR }, Verdict::Ambiguous),
            (Evidence { instrument_causes: 1, ..CLEAR }, Verdict::NoiseModelSuspect),
            (Evidence { instrument_causes: 1, causes: 2, ..CLEAR }, Verdict::Named),
            (Evidence { trifling: true, ..left }, Verdict::Unknown),
            (Evidence { slow: true, ..none }, Verdict::NoiseModelSuspect),
            (Evidence { cancels: true, ..CLEAR }, Verdict::Unknown),
            (Evidence { cancels: true, ambiguous: true, ..CLEAR }, Verdict::Unknown),
            (Evidence { cancels: true, ..none }, Verdict::NoGap),
            // What may not be written is not NAMED.
            (Evidence { risks: true, ..CLEAR }, Verdict::Partial),
            (Evidence { risks: true, ambiguous: true, ..CLEAR }, Verdict::Ambiguous),
            (Evidence { exceeds: true, ..none }, Verdict::NoiseModelSuspect),
            (Evidence { guessed: true, ..none }, Verdict::Underpowered),
            (Evidence { guessed: true, ..CLEAR }, Verdict::Named),
            (Evidence { exceeds: true, ..CLEAR }, Verdict::Named),
        ];
        for (evidence, expected) in cases {
            assert_eq!(verdict(&evidence), expected, "{evidence:?}");
        }
    }

    /// Forecast 50 % (40 % at least) of a gap ten times the noise.
    #[test]
    fn unseen_rows_have_the_last_word() {
        let kept = Unseen {
            before: 10.0,
            after: 5.0,
            promised: (0.4, 0.5),
            error: 0.01,
            chance: 0.1,
            alone: false,
            worse: None,
        };
        let worse = Some(WorseRun { run: 1, before_um: 6.6, after_um: 7.3 });
        let with = |unseen: Unseen, e: Evidence| verdict(&Evidence { unseen: Some(unseen), ..e });
        let after = |after: f64| Unseen { after, ..kept };
        let none = Evidence { causes: 0, ..CLEAR };
        let open = Evidence { ambiguous: true, ..CLEAR };
        let left = Evidence { phi: 0.2, lack_of_fit_p: 1e-6, ..CLEAR };
        for (found, expected) in [
            (with(kept, CLEAR), Verdict::Named),
            (with(after(6.4), CLEAR), Verdict::Named),
            (with(after(7.0), CLEAR), Verdict::Partial),
            (with(after(7.0), open), Verdict::Partial),
            (with(after(9.0), CLEAR), Verdict::Unknown),
            (with(after(11.0), open), Verdict::Unknown),
            (with(after(11.0), left), Verdict::Unknown),
            (with(after(7.0), left), Verdict::Partial),
            // One run that gets worse is not outweighed by others that get better.
            (with(Unseen { worse, ..kept }, CLEAR), Verdict::Partial),
            (with(Unseen { worse, ..kept }, none), Verdict::Unknown),
            // Few rows prove little, and what is left at the level of the noise refutes nothing.
            (with(Unseen { error: 0.2, ..after(7.0) }, CLEAR), Verdict::Named),
            (with(Unseen { before: 2.0, after: 1.5, ..kept }, CLEAR), Verdict::Named),
            (with(Unseen { before: 1.4, after: 1.4, ..kept }, none), Verdict::NoGap),
            (with(Unseen { before: 1.4, chance: 0.07, ..kept }, none), Verdict::Unknown),
            (with(Unseen { before: 1.2, chance: 0.01, ..kept }, none), Verdict::NoGap),
            (with(Unseen { before: 1.6, after: 1.6, ..kept }, none), Verdict::Unknown),
            (with(Unseen { before: 1.2, after: 1.2, alone: true, ..kept }, none), Verdict::Unknown),
        ] {
            assert_eq!(found, expected);
        }
    }
}
