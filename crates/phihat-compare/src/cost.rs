//! The cost of a run, by which gains are tuned.

use phihat_study::Study;

use crate::run_outcome::{Figures, RunOutcome};

/// Torque noise that tuned gains may have, over the torque limit: mean step from sample to sample.
pub const NOISE_CAP: f64 = 0.01;

/// Cost of noise at its cap \[rad\]: no error of a quieter run that followed is as large.
const NOISY: f64 = 10.0;

/// Cost of a run that reached its end without following \[rad\], or with torques that met their limits: no noise is as
/// bad.
const LOST: f64 = 500.0;

/// Share of samples at a torque limit beyond which nothing is controlled, where the limits leave room.
pub const LIMITED: f64 = 0.02;

/// Cost of a run that did not reach its end \[rad\], more the sooner it ended: no error of a run that did is as
/// large.
const UNFINISHED: f64 = 1e3;

/// The error where the noise keeps its cap; how far it is beyond where not; above that, the error of a run that did
/// not follow, or lived on its torque limits; above all, how soon it ended where it did.
pub(crate) fn cost(study: &Study, outcome: &RunOutcome, figures: Option<&Figures>) -> f64 {
    match (outcome, figures) {
        (outcome, Some(figures)) if !outcome.followed() || figures.saturated > LIMITED => {
            (LOST + figures.error_rms_rad).min(UNFINISHED)
        }
        (_, Some(figures)) if figures.noise <= NOISE_CAP => figures.error_rms_rad.min(NOISY),
        (_, Some(figures)) => (NOISY * figures.noise / NOISE_CAP).min(LOST),
        (RunOutcome::Diverged { t, .. } | RunOutcome::NotFinite { t, .. }, None) => {
            UNFINISHED * (2.0 - t / study.duration)
        }
        _ => f64::INFINITY,
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests: a panic is the report")]

    use super::{Figures, NOISE_CAP, RunOutcome, Study, cost};

    /// However large the error and however small the noise: following comes before quiet, quiet before exact.
    #[test]
    fn gains_that_do_not_follow_are_worse_than_noise_and_better_than_an_early_end() {
        let text = "duration_s = 4.0\n[robot]\nname = \"planar3r\"\n[design]\n[reference]\nkind = \"hold\"\npose = \
            \"ready\"\n";
        let study = Study::from_text(text, "cost.toml", std::path::Path::new(".")).unwrap();
        let run = |error_rms_rad: f64, noise: f64, saturated: f64| Figures {
            error_rms_rad,
            error_peak_rad: error_rms_rad,
            error_over_spec: 1.0,
            effort: 0.1,
            chatter_nm: 0.0,
            chatter_over_exact: None,
            noise,
            noise_above_50_hz: None,
            saturated,
            recovery_s: None,
            error_bound_rad: None,
            bound_over_measured: None,
        };
        let lost = RunOutcome::Lost { joint: "joint1".to_owned() };
        let ended = RunOutcome::Diverged { t: 3.9, joint: "joint1".to_owned() };
        let ladder = [
            (&RunOutcome::Followed, Some(run(1e-4, 0.5 * NOISE_CAP, 0.0))),
            (&RunOutcome::Followed, Some(run(1e-2, NOISE_CAP, 0.01))),
            (&RunOutcome::Followed, Some(run(1e-6, 2.0 * NOISE_CAP, 0.0))),
            (&RunOutcome::Followed, Some(run(1e-6, 9.0 * NOISE_CAP, 0.0))),
            (&RunOutcome::Followed, Some(run(1e-6, 0.0, 0.5))),
            (&lost, Some(run(0.8, 0.0, 0.0))),
            (&ended, None),
        ];
        let costs: Vec<f64> = ladder
            .iter()
            .map(|(outcome, figures)| cost(&study, outcome, figures.as_ref()))
            .collect();
        assert!(costs.windows(2).all(|pair| pair[0] < pair[1]), "{costs:?}");
    }
}
