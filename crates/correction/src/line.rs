//! Following a curve with lines.

use machine_model::{Command, Vector};

use crate::corrected::Directed;
use crate::corrector::Corrector;
use crate::curve::Curve;
use crate::deviation::{Pair, Verdict};
use crate::error::CorrectionError;
use crate::follow::Follow;
use crate::grid::{Block, Goal};
use crate::play::{Creep, Tried};
use crate::pointing::{Demand, Pointing};
use crate::{Centre, Piece, PieceKind};

/// A piece shorter than this many output steps cannot be split further to any use.
const SHORTEST_STEPS: f64 = 4.0;

impl<'m> Corrector<'m> {
    /// Commands lines from where the axes stand to the end of `part`, as few as hold the tolerance.
    pub(crate) fn follow_line(
        &mut self,
        follow: &mut Follow<'_, 'm>,
        part: &Curve,
    ) -> Result<(), CorrectionError> {
        let (distance_mm, s, exactly) = match self.with_play(follow, part, Self::one_line)? {
            Tried::Beyond { .. } if self.meet_halfway(follow, part)? => {
                return self.follow_line(follow, part);
            }
            Tried::Beyond { distance_mm, s } => (distance_mm, s, false),
            Tried::Corner(corner) => (corner.distance_mm, corner.s, true),
            Tried::Done | Tried::Against(_) => return Ok(()),
        };
        let step = (0..3).map(|i| follow.block.step_mm(i)).fold(0.0, f64::max);
        let length = part.length_mm();
        // No split helps an axis that must stay where it is.
        self.require_named(follow, part, self.limit_mm(follow.block))?;
        if let Some(rad) = follow.leans_rad.filter(|_| !follow.may_split || length < SHORTEST_STEPS * step) {
            let allowed_urad = self.options.orientation_rad * 1e6;
            return Err(CorrectionError::Leans { leans_urad: rad * 1e6, allowed_urad });
        }
        let least_share = follow.least_share(part);
        if !follow.may_split || least_share > 0.5 {
            self.require_named(follow, part, 0.5 * step)?;
            return Err(self.not_to_be_split(follow, distance_mm));
        }
        if self.is_too_short(follow.block, part) {
            self.require_named(follow, part, 0.5 * step)?;
            return Err(CorrectionError::NotWithinTolerance {
                distance_um: distance_mm * 1e3,
                tolerance_um: self.options.tolerance_mm * 1e3,
            });
        }
        follow.alone = false;
        let shortest = (self.options.minimum_segment_mm / length).clamp(0.05, 0.5).max(least_share);
        let s = if exactly { s } else { s.clamp(shortest, 1.0 - shortest) };
        self.follow_line(follow, &part.part(0.0, s))?;
        self.follow_line(follow, &part.part(s, 1.0))
    }

    /// A part that cannot be split to any use.
    pub(crate) fn is_too_short(&self, block: &Block, part: &Curve) -> bool {
        let step = (0..3).map(|i| block.step_mm(i)).fold(0.0, f64::max);
        let length = part.length_mm();
        length < SHORTEST_STEPS * step || length < 2.0 * self.options.minimum_segment_mm
    }

    /// Tries one line to the end of `part`; the axes stand where they stood unless it is done.
    fn one_line(
        &mut self,
        follow: &mut Follow<'_, 'm>,
        part: &Curve,
        creep: Creep,
    ) -> Result<Tried, CorrectionError> {
        let directed = follow.turning.and_then(|turning| turning.directed);
        let mut rotary = match &directed {
            Some(standing) => self.directed_words(follow, part, standing)?,
            None => follow.rotary_words(part),
        };
        let mut at_end = follow.machine.clone();
        if let Some(rotary) = &rotary {
            at_end.state.rotary_rad = rotary.end_rad;
        }
        let swing = rotary.as_ref().and_then(|rotary| self.swing(&follow.machine.state, rotary.end_rad));
        let mut machine = follow.machine.clone();
        if let Some((swing, rotary)) = swing.as_ref().zip(rotary.as_ref()) {
            if let Some(corner) = self.corner(follow, part, swing, rotary) {
                return Ok(Tried::Corner(corner));
            }
            [machine.state.rotary_play, at_end.state.rotary_play] = swing.ends;
            machine.lag_rad = Some(swing.ends.map(|end| end.lag_rad));
        }
        let nominal_end = at_end.target(part, 1.0);
        let wanted = self.solve(&at_end.state, nominal_end)?;
        let before = self.standing;
        let from: Vector = before.map(|v| v.unwrap_or(f64::NAN)).into();
        let own_end = follow.own_end(part, &from);
        let axes = self.go(follow.block, &own_end, &wanted, &follow.freedom(part, creep.held()));
        if !matches!(creep, Creep::Counted)
            && let Some(against) = self.against(&at_end.state, before, self.standing, follow.block)
        {
            self.standing = before;
            return Ok(Tried::Against(against));
        }
        let to: Vector = self.standing.map(|v| v.unwrap_or(f64::NAN)).into();
        let commanded = match &rotary {
            Some(rotary) => Curve::Turn {
                ends: [from, to],
                rotary_rad: [follow.machine.state.rotary_rad, rotary.end_rad],
            },
            None => Curve::Line(from, to),
        };
        let pair = Pair {
            wanted: part,
            commanded: &commanded,
            in_step: follow.whole.in_step,
            begun: self.begun(follow, part),
        };
        if let (Some(turn), None) = (pair.turn(&machine, 0.0, 1.0), &directed) {
            self.require_direction(&turn)?;
        }
        let solved =
            if follow.foreseen { self.solved_line(&follow.machine.state, part, wanted) } else { None };
        let limit_mm = self.limit_mm(follow.block);
        follow.leans_rad = None;
        let verdict = match &swing {
            Some(swing) if swing.has_corners() && !self.model.depends_on_direction() => {
                self.verdict_by_corners(&machine, &pair, swing, limit_mm)
            }
            _ => {
                let verdict = pair.line_verdict_by(&machine, solved.as_ref(), limit_mm);
                let corners_mm = swing.as_ref().map_or(0.0, |swing| {
                    self.beside_corners_mm(follow, part, swing, at_end.state.rotary_rad)
                });
                self.verdict_with_play(&machine, &pair, verdict, limit_mm).further_by(corners_mm, limit_mm)
            }
        };
        match verdict {
            Verdict::Within(bound) => {
                if let (Some(standing), Some(rotary)) = (&directed, &mut rotary) {
                    let is_reached = standing.reached && rotary.reached;
                    let demand = if is_reached { Demand::Proven } else { Demand::AsNearAsMayBe };
                    match self.piece_leans(&pair, &machine, demand)? {
                        Pointing::Holds(found) => {
                            follow.note_direction(&found);
                            rotary.turning.note_direction(&found);
                        }
                        Pointing::Leans { s, rad } => {
                            self.standing = before;
                            follow.leans_rad = Some(rad);
                            return Ok(Tried::Beyond { distance_mm: bound, s });
                        }
                    }
                }
                let words = rotary.as_ref().map(|rotary| rotary.words);
                follow.finish(
                    Piece { kind: PieceKind::Line, axes, rotary: words, share: follow.share(part) },
                    bound,
                    (wanted - nominal_end).norm(),
                );
                self.gone_along(&at_end.state, &commanded);
                self.note_end(&at_end.state, nominal_end, wanted);
                if let Some(swing) = swing {
                    self.play = swing.play;
                }
                if let Some(rotary) = rotary {
                    follow.turning = Some(rotary.turning);
                    follow.machine.state.rotary_rad = rotary.end_rad;
                    follow.machine.state.rotary_play = self.rotary_play(rotary.end_rad);
                    follow.commanded_mm += commanded.linear_mm();
                }
                Ok(Tried::Done)
            }
            Verdict::Beyond { distance_mm, .. } => {
                self.standing = before;
                Ok(Tried::Beyond { distance_mm, s: pair.worst_place(&machine) })
            }
        }
    }
}

impl Corrector<'_> {
    /// The commands that bring the tool to a line at s = 0, ½, 1, where they were all found before.
    fn solved_line(&self, state: &Command, part: &Curve, end: Vector) -> Option<[Vector; 3]> {
        let found = |s: f64| self.found(state, part.at(s));
        Some([found(0.0)?, found(0.5)?, end])
    }
}

impl Follow<'_, '_> {
    /// Takes note of where the tool points on a piece.
    fn note_direction(&mut self, found: &Directed) {
        let known = self.corrected.correction.directed.get_or_insert_default();
        known.after_rad = known.after_rad.max(found.after_rad);
        known.held |= found.held;
    }

    /// Adds a piece that was proven, unless it is the block as it stands or moves nothing.
    pub(crate) fn finish(&mut self, piece: Piece, bound_mm: f64, correction_mm: f64) {
        let figures = &mut self.corrected.correction;
        figures.after_mm = figures.after_mm.max(bound_mm);
        figures.largest_mm = figures.largest_mm.max(correction_mm);
        let still = piece.axes.iter().all(|word| *word == Goal::Stays) && piece.rotary.is_none();
        let same_centre = match piece.kind {
            PieceKind::Arc { centre: Centre::Offsets(words), .. } => {
                words.iter().all(|word| matches!(word, Goal::AsStated | Goal::Stays))
            }
            PieceKind::Arc { centre: Centre::Radius(word), .. } => word == Goal::AsStated,
            _ => true,
        };
        let untouched = self.alone
            && same_centre
            && piece.axes.iter().all(|word| matches!(word, Goal::AsStated | Goal::Stays))
            && piece.rotary.is_none_or(|words| words.iter().all(|word| !matches!(word, Goal::Steps(_))));
        if untouched || (still && !matches!(piece.kind, PieceKind::Arc { .. })) {
            return;
        }
        self.corrected.pieces.push(piece);
    }
}
