//! Around the law: the supervisor and the robot's torque interface.

use phihat_model::Profile;
use phihat_study::{Interface, SupervisorRequest};

use super::list::{LeftOut, List};

/// End of a supervised motion, of which no claim speaks.
const SAFE_STOP: &str = "supervisor: a safe stop";

/// Keys of monitors and modes that change nothing until the arm stops.
pub(super) const STOPS: [&str; 6] = [
    "supervisor.velocity_max_rad_s",
    "supervisor.error_stop_rad",
    "supervisor.frozen_travel_rad",
    "supervisor.oscillation_nm",
    "supervisor.first_motion_nm",
    SAFE_STOP,
];

/// Key of a reference that is shaped.
const SHAPED: &str = "supervisor.reference_velocity_max_rad_s";

impl List {
    /// A bound for a class of motions counts gravity that the robot adds, and a start of a supervisor's law.
    pub(super) fn interface(&mut self, interface: &Interface, class: bool) {
        let Interface { profile, kept } = interface;
        let Profile {
            name,
            // For people.
            description: _,
            source: _,
            // Checked where the study is read.
            rate_min: _,
            rate_max: _,
            adds_gravity,
            adds_friction,
            clamps_torque,
            torque_rate_max,
            first_torque_max,
            // Nothing without losses, which are listed.
            losses_max: _,
            // Forbids the loop model.
            torque_filter: _,
        } = profile;
        if *adds_gravity && !class {
            self.add("profile.adds_gravity", format!("true ({name})"), LeftOut::AllButTube);
        }
        if *adds_friction > 0.0 {
            let text = format!("{adds_friction} ({name})");
            self.add("profile.adds_friction", text, LeftOut::AllButTube);
        }
        // Kept, its rules are limits of the loop like any other; else the robot stops, or clamps unseen.
        let rules = *clamps_torque || torque_rate_max.is_some() || first_torque_max.is_some();
        if rules && !kept {
            let text = format!("false ({name})");
            self.add("profile.controller_keeps", text, LeftOut::BoundsAndStability);
        }
        if let Some(most) = first_torque_max.filter(|_| *kept && !class) {
            // The first command is left out to keep it.
            self.add("profile.first_torque_max_nm", most, LeftOut::AllButTube);
        }
    }

    /// Nothing of a supervisor is in the loop model: what adds nothing until it acts, and what acts always. The bound
    /// for a class of motions counts its modes, its references and its start.
    pub(super) fn supervisor(&mut self, request: &SupervisorRequest, class: bool) {
        let SupervisorRequest {
            velocity_max,
            error_stop,
            frozen_travel,
            oscillation,
            first_motion,
            dead_zone,
            soft_zone,
            // The soft zone's.
            braking: _,
            motion,
            funnel,
            // The funnel's.
            funnel_decay: _,
            preset,
            // In the bound for a class, and what it says: beyond it the arm stops.
            reference_box: _,
            start_imbalance: _,
            error_bound: _,
            error_bound_stop: _,
            start_first_order,
            start_factor,
            // When the start gains end, and whether they come back.
            settled: _,
            disturbed: _,
            dwell: _,
            // What stops the arm, and what holds it then.
            saturation: _,
            brake_closing: _,
            // After the motion that the claims are about.
            park: _,
            // Nothing without losses and refused samples, which are listed.
            hold_samples: _,
            stop_samples: _,
            // No tracking beyond it.
            start_mismatch_max: _,
            blend,
            requests,
        } = request;
        self.acting("supervisor.velocity_max_rad_s", velocity_max.as_ref());
        self.acting("supervisor.error_stop_rad", error_stop.as_ref());
        self.acting("supervisor.frozen_travel_rad", frozen_travel.as_ref());
        self.acting("supervisor.oscillation_nm", oscillation.as_ref());
        self.acting("supervisor.first_motion_nm", first_motion.as_ref());
        self.acting("supervisor.dead_zone_rad", dead_zone.as_ref());
        self.acting("supervisor.soft_zone_rad", soft_zone.as_ref());
        if let Some([velocity, ..]) = motion.as_ref().filter(|_| !class) {
            // Outside of the loop: it is the reference that is another one.
            self.add(SHAPED, format!("{velocity:?}"), LeftOut::Bounds);
        }
        self.acting("supervisor.funnel_initial_rad", funnel.as_ref().map(|[initial, _]| initial));
        if let Some(torque) = preset.as_ref().filter(|_| !class) {
            self.add("supervisor.preset_nm", format!("{torque:?}"), LeftOut::Bounds);
        }
        if *start_first_order {
            // Its window is looked at before arming; the bounds are those of the running gains.
            let text = format!("true, blended over {blend} s");
            self.add("supervisor.start_first_order", text, LeftOut::Bounds);
        }
        if let Some(factor) = start_factor {
            self.add("supervisor.start_estimator_factor", factor, LeftOut::Bounds);
        }
        if class {
            let text = "ends the claim about the class; docs/theory/stop.md says what holds in it";
            return self.add(SAFE_STOP, text, LeftOut::Bounds);
        }
        // The arm is armed, holds, and then tracks: the reference begins some samples late.
        let modes = requests.iter().map(|(t, mode)| format!("{mode:?} at {t} s"));
        let modes = modes.collect::<Vec<_>>().join(", ").to_lowercase();
        let text = if modes.is_empty() { "arm, hold and track at once".to_owned() } else { modes };
        self.add("supervisor.request", text, LeftOut::Bounds);
    }
}
