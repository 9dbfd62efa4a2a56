//! That the bound for a class fits the rest of its document.

use super::document::ClassBound;
use crate::check::plausible::at_most;
use crate::{Certificate, Refutation};

const CLAIM: &str = "class of motions";

/// Rounding of a bound beside a limit.
const ROUNDING: f64 = 1.0 + 1e-9;

impl Certificate {
    /// Checks of a bound for a class its lists of one entry per joint, numbers that can be, and that no limit acts.
    ///
    /// # Errors
    ///
    /// The first [`Refutation`].
    pub fn class_fits(&self) -> Result<(), Refutation> {
        let yes = Refutation::unless;
        let both = self.class.is_some() && self.class_refused.is_some();
        yes(CLAIM, "a bound, or the reason why there is none", 1.0, 0.0, !both)?;
        let Some(class) = &self.class else { return Ok(()) };
        let whole = self.refused().is_none();
        yes(CLAIM, "no claim rests on a refused one", 1.0, 0.0, whole)?;
        let n = self.joints.len();
        class.sized(n)?;
        at_most(CLAIM, "spectral radius < 1", class.spectral_radius, 1.0)?;
        yes(CLAIM, "at least one witness", 0.0, 1.0, !class.witnesses.is_empty())?;
        for (i, joint) in self.joints.iter().enumerate() {
            let named = |why: Refutation| why.on(&joint.name);
            let period = joint.model.period_s;
            let quantum = joint.noise.as_ref().map_or(0.0, |noise| noise.quantum_rad);
            at_most(
                CLAIM,
                "half a quantum ≤ error of a reading",
                0.5 * quantum,
                class.reading_rad[i] * ROUNDING,
            )
            .map_err(named)?;
            if let Some(limit) = joint.limits.0 {
                at_most(CLAIM, "torque ≤ its limit", class.torque_nm[i], limit * ROUNDING)
                    .map_err(named)?;
            }
            if let Some(rate) = joint.limits.1 {
                let step = rate * period * ROUNDING;
                at_most(CLAIM, "torque step ≤ its limit", class.torque_step_nm[i], step)
                    .map_err(named)?;
            }
        }
        Ok(())
    }
}

impl ClassBound {
    /// Every list by its name.
    fn lists(&self) -> [(&'static str, &Vec<f64>); 10] {
        [
            ("speed", &self.speed_max_rad_s),
            ("acceleration", &self.acceleration_max_rad_s2),
            ("jerk", &self.jerk_max_rad_s3),
            ("force", &self.force_nm),
            ("error of a reading", &self.reading_rad),
            ("|e|", &self.error_bound_rad),
            ("|ė|", &self.velocity_error_bound_rad_s),
            ("torque step", &self.torque_step_nm),
            ("torque", &self.torque_nm),
            ("|e| of a frozen arm", &self.frozen_error_bound_rad),
        ]
    }

    fn sized(&self, n: usize) -> Result<(), Refutation> {
        let yes = Refutation::unless;
        for (name, list) in self.lists() {
            yes(
                CLAIM,
                &format!("one {name} per joint"),
                list.len() as f64,
                n as f64,
                list.len() == n,
            )?;
            for value in list {
                let fine = *value >= 0.0 && value.is_finite();
                yes(CLAIM, &format!("0 ≤ {name} < ∞"), *value, 0.0, fine)?;
            }
        }
        let started = if self.is_supervised() { n } else { 0 };
        let starts = self.start_nm.len();
        yes(CLAIM, "one start per joint", starts as f64, started as f64, starts == started)?;
        for value in self.start_nm.iter().chain([&self.start_s]) {
            let fine = *value >= 0.0 && value.is_finite();
            yes(CLAIM, "0 ≤ start out of balance < ∞", *value, 0.0, fine)?;
        }
        if let Some(signals) = &self.signals {
            let lists = [&signals.stiction_nm, &signals.stiction_nm_s_rad];
            let cogs = [&signals.cogging_nm, &signals.cogging_per_turn];
            let all = |list: &Vec<f64>| list.len() == n;
            let sized = lists.into_iter().all(all)
                && (cogs.into_iter().all(Vec::is_empty) || cogs.into_iter().all(all));
            yes(CLAIM, "one stiction and cogging per joint", 0.0, n as f64, sized)?;
            let numbers = lists.into_iter().chain(cogs).flatten();
            for value in numbers.chain([&signals.jitter_s, &signals.lost_every_s]) {
                let fine = *value >= 0.0 && value.is_finite();
                yes(CLAIM, "0 ≤ imperfection of a signal < ∞", *value, 0.0, fine)?;
            }
        }
        let (low, high) = &self.box_rad;
        let same = low.len() == n && high.len() == n;
        yes(CLAIM, "one end of the box per joint", low.len() as f64, n as f64, same)?;
        for (low, high) in low.iter().zip(high) {
            at_most(CLAIM, "low ≤ high end of the box", *low, *high)?;
            at_most(CLAIM, "|end of the box| < ∞", low.abs().max(high.abs()), f64::MAX)?;
        }
        for witness in &self.witnesses {
            let sized = witness.q_rad.len() == n;
            yes(
                CLAIM,
                "a witness is a posture of the arm",
                witness.q_rad.len() as f64,
                n as f64,
                sized,
            )?;
            for ((q, low), high) in witness.q_rad.iter().zip(low).zip(high) {
                at_most(CLAIM, "a witness is inside the box", low - 1e-9, *q)?;
                at_most(CLAIM, "a witness is inside the box", *q, high + 1e-9)?;
            }
        }
        Ok(())
    }
}
