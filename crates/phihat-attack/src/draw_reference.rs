//! Random references: holds, sines, waypoints, circles.

use core::f64::consts::TAU;
use core::fmt::Write as _;

use phihat_model::Workspace;

use crate::hand::Hand;

impl Hand<'_> {
    pub(crate) fn reference(&mut self) -> String {
        let share = self.dice.share();
        let at = self.posture();
        let (start, motion) = if share < 0.2 {
            self.tag("hold");
            (Some(at.clone()), format!("kind = \"hold\"\nq_rad = {at:?}\n"))
        } else if share < 0.65 {
            self.tag("sines");
            (Some(at.clone()), self.sines(&at))
        } else if share < 0.85 {
            self.tag("waypoints");
            (Some(at.clone()), self.waypoints(&at))
        } else {
            self.tag("circle");
            (None, self.circle(&at))
        };
        let mut text = String::new();
        let away = self.dice.chance(0.15);
        if self.dice.chance(0.2) {
            self.tag("held");
            text += "\n[start]\ntorque_nm = \"gravity\"\n";
        }
        if let Some(start) = start.filter(|_| away) {
            self.tag("start");
            let far = self.dice.log_between(1e-4, 0.03);
            let q: Vec<f64> = start.iter().map(|q| q + self.dice.between(-far, far)).collect();
            if text.is_empty() {
                text += "\n[start]\n";
            }
            let _ = writeln!(text, "q_rad = {q:?}");
            if self.dice.chance(0.3) {
                let fast = self.dice.log_between(1e-3, 0.1);
                let dq: Vec<f64> = q.iter().map(|_| self.dice.between(-fast, fast)).collect();
                let _ = writeln!(text, "dq_rad_s = {dq:?}");
            }
        }
        text + "\n[reference]\n" + &motion
    }

    /// A sum of sines around a posture, inside limits of position and speed.
    fn sines(&mut self, at: &[f64]) -> String {
        let vivid = self.dice.log_between(0.05, 0.8);
        let mut text = format!("kind = \"sines\"\ncenter_rad = {at:?}\n");
        let fade = self.dice.pick(&[0.0, 0.3, 1.0, 1.0]);
        let _ = writeln!(text, "fade_in_s = {fade:?}");
        let terms = self.dice.pick(&[1, 1, 2]);
        for _ in 0..terms {
            let (mut amplitude, mut frequency, mut phase) = (vec![], vec![], vec![]);
            for (i, at) in at.iter().enumerate() {
                let (low, high) = self.range(i);
                let room = (high - at).min(at - low) / f64::from(terms);
                let fastest = self.robot.joints[i].velocity_max.unwrap_or(2.0) / f64::from(terms);
                let f = self.dice.log_between(0.1, 2.0);
                let still = self.dice.chance(0.1);
                let most = room.min(0.4 * fastest / (TAU * f)).min(1.0);
                amplitude.push(if still {
                    0.0
                } else {
                    vivid * most * self.dice.between(0.3, 1.0)
                });
                frequency.push(f);
                // Without a fade-in a run that starts on the reference starts in motion.
                phase.push(if fade > 0.0 { self.dice.between(0.0, TAU) } else { 0.0 });
            }
            let _ = write!(
                text,
                "\n[[reference.sine]]\namplitude_rad = {amplitude:?}\nfrequency_hz = {frequency:?}\n\
                 phase_rad = {phase:?}\n"
            );
        }
        text
    }

    fn waypoints(&mut self, at: &[f64]) -> String {
        let mut text = "kind = \"waypoints\"\n".to_owned();
        let (mut t, mut q) = (0.0, at.to_vec());
        // A leg lasts 0.3 s or more.
        for _ in 0..16 {
            let _ = write!(text, "\n[[reference.waypoint]]\nt_s = {t:?}\nq_rad = {q:?}\n");
            let leg = self.dice.between(0.3, 2.0);
            let vivid = self.dice.log_between(0.05, 0.8);
            for (i, q) in q.iter_mut().enumerate() {
                let (low, high) = self.range(i);
                let fastest = self.robot.joints[i].velocity_max.unwrap_or(2.0);
                // A quintic's largest speed is 15/8 of its mean.
                let far = (0.5 * fastest * leg * vivid).min(0.3 * (high - low));
                *q = (*q + self.dice.between(-far, far)).clamp(low + 0.02, high - 0.02);
            }
            t += leg;
            if t >= self.duration {
                break;
            }
        }
        text
    }

    /// A circle through the tip's place at a posture.
    fn circle(&mut self, at: &[f64]) -> String {
        let mut workspace = Workspace::new(&self.robot.model);
        self.robot.model.forward_kinematics(&mut workspace, at);
        let tip = self.robot.model.frame(&self.robot.tip);
        let p = tip.map_or([0.0; 3], |tip| self.robot.model.pose(&workspace, tip).p);
        let radius = self.dice.log_between(0.005, 0.08);
        let planar = self.robot.name == "planar3r";
        let normal = if planar {
            [0.0, 1.0, 0.0]
        } else {
            self.dice.pick(&[[0.0, 0.0, 1.0], [0.0, 1.0, 0.0]])
        };
        let center = [p[0] - radius, p[1], p[2]];
        let period = self.dice.between(1.0, 5.0);
        format!(
            "kind = \"circle\"\ncenter_m = {center:?}\nradius_m = {radius:?}\nnormal = {normal:?}\n\
             period_s = {period:?}\nfade_in_s = {:?}\nseed_rad = {at:?}\n",
            self.dice.pick(&[0.3, 1.0])
        )
    }
}
