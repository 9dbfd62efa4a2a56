//! Words that page and command share.

use crate::{Comparison, GainsKind, RivalRecord, WorldRecord};

use phihat_report::kit::number::stated;
use phihat_report::kit::text::line;

/// Factors on the scalars of every law, in words.
pub const UNITS: &str = "one value for all joints; where a gain acts on torque it is multiplied by U, one nominal \
                         inertia per joint of the arm (a PD has K_P = U ω²), the same for every law, or by the inertia \
                         or model that the law is handed";

/// Origin of the default gains, in words.
pub const DEFAULTS: &str = "from the source where it prints some that could be used, else this project's own choice; a \
                            tuning starts from them";

/// Of a law whose gains are designed.
pub const NOT_TUNED: &str = "no free scalar: they are `phihat design STUDY`'s, for the specification or, from \
                             positions, for the tuning's cap on noise as a torque step; the same in every world";

/// Returns true if nothing can be chosen of a law: its gains are designed, and its runs have one kind of
/// gains.
pub(super) fn is_designed(rival: Option<&RivalRecord>) -> bool {
    rival.is_some_and(|rival| rival.needs.designed)
}

/// `yes` for a law that needs no model, `partly` where its gains are designed, else `no`.
pub fn model_free(rival: &RivalRecord) -> &'static str {
    match (rival.needs.model_free(), rival.needs.designed) {
        (false, _) => "no",
        (true, false) => "yes",
        (true, true) => "partly",
    }
}

/// Result of [`model_free`], in a sentence.
pub fn model_free_in_full(rival: &RivalRecord) -> &'static str {
    match model_free(rival) {
        "no" => "not model free",
        "yes" => "model free: of the arm it has nothing but U",
        _ => {
            "the law is model free; its design wants the range of the arm's inertia and a bound on its load"
        }
    }
}

pub(super) fn gains(kind: GainsKind) -> &'static str {
    match kind {
        GainsKind::Default => "default",
        GainsKind::Tuned => "tuned",
    }
}

/// Contents of a world, and what is not exact in the exact one.
pub(super) fn world(comparison: &Comparison, world: &WorldRecord) -> String {
    let what = line(&world.what);
    let percent = (100.0 * (comparison.fairness.nominal_masses - 1.0)).round();
    if world.name != "exact" || percent.abs() < 1.0 {
        return what;
    }
    let side = if percent < 0.0 { "light" } else { "heavy" };
    let off = format!("{} % too {side}", stated(percent.abs()));
    format!(
        "{what}. Exact are the sensors: the model that a law may be handed has links {off}, here as everywhere"
    )
}
