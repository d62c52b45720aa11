//! What to do about each cause.

use machine_model::effects::EffectKind;

/// One sentence for the shop floor.
#[must_use]
pub const fn remedy(kind: EffectKind) -> &'static str {
    match kind {
        EffectKind::Scale(_) => {
            "Set the scale factor of the axis (screw pitch compensation end value), or let the correction do it; check the scale's temperature first."
        }
        EffectKind::Thermal(_) => {
            "Measure at reference temperature, or compensate with the axis' own temperature and this coefficient."
        }
        EffectKind::Warmup(_) => {
            "Warm the machine up before measuring and cutting, for at least three time constants."
        }
        EffectKind::Backlash(_) => {
            "Set the control's backlash compensation to twice the half width, or have screw, nut and bearing preload checked."
        }
        EffectKind::LostMotion { .. } => {
            "Check gibs and guideway preload: the carriage steps sideways when it reverses."
        }
        EffectKind::Squareness(..) => {
            "Enter the squareness in the profile, or realign the axes if it exceeds the machine's tolerance."
        }
        EffectKind::Positioning(_) => "Measure the axis with an interferometer and enter its table.",
        EffectKind::Straightness { .. } => {
            "Measure the axis' straightness and enter its table; check the levelling of the bed."
        }
        EffectKind::Pitch(_) => {
            "Check the screw's end bearing and the encoder coupling; a table with steps below a quarter of the pitch corrects it."
        }
        EffectKind::Angular { .. } => {
            "Measure the axis' angles with level or interferometer and enter its table; check the guideways."
        }
        EffectKind::Sag(_) => {
            "Use the control's droop compensation over the overhang, or check the ram's counterbalance."
        }
        EffectKind::Load(_) => {
            "Enter the load with the effect, or compensate the counterbalance; keep the load near the calibrated one."
        }
        EffectKind::ServoLag(_) => {
            "Switch feed-forward on or measure at low feed: the error is made by the speed, not by the place."
        }
        EffectKind::ServoMismatch(..) => "Match the position loop gains of the two axes.",
        EffectKind::Rotary { .. } => "Calibrate the location of the rotary axis and enter it in the profile.",
        EffectKind::Eccentricity(_) => {
            "Check the mounting of the rotary encoder or table: the error comes once per turn."
        }
        EffectKind::ProbeLobing => {
            "Calibrate the probe in the directions used; the machine is not the cause."
        }
        EffectKind::InstrumentDrift => {
            "Let the instrument settle and return to a reference point between lines; the machine is not the cause."
        }
        EffectKind::Step(_) => {
            "Ask what happened at that time (collision, clamping, restart) and measure again."
        }
        EffectKind::Local(_) => "Inspect the guideway or scale at that place for damage or dirt.",
        EffectKind::Joint(_) => {
            "Realign the rails where they join, or enter a table with a node on each side of the joint."
        }
        EffectKind::Spike(_) => {
            "Set the control's friction (quadrant) compensation for this axis; check lubrication and gibs."
        }
        EffectKind::Contraction => {
            "Raise the position loop gain or use acceleration feed-forward; until then finish round parts at the slower feed."
        }
        EffectKind::SpindleTilt(_) => {
            "Tram the spindle, or correct each tool by its length: the axes are not the cause."
        }
        EffectKind::Tracker(_) => {
            "Run the tracker's own two-face and ranging checks and compensate it; the machine is not the cause."
        }
    }
}
