//! Random loops with a law from positions for each joint.

use core::f64::consts::PI;
use core::fmt::Write as _;

use phihat_model::Workspace;
use phihat_session::Dice;

use crate::draft::DraftLaws;
use crate::filtered::seed;
use crate::hand::Hand;
use crate::spectrum::inverse;

/// Postures over which a nominal inertia is guessed.
const POSTURES: usize = 12;

impl Hand<'_> {
    /// `[loop]`, and the length of the run: short, so that there are many.
    pub(crate) fn positions_control(&mut self) -> String {
        self.rate = self.dice.pick(&[250.0, 333.0, 500.0, 500.0, 1000.0, 1000.0, 1000.0, 2000.0]);
        let longest = if self.dice.chance(0.2) { 1.8 } else { 0.9 };
        self.duration = self.dice.between(0.4, if self.rate > 1000.0 { 0.7 } else { longest });
        self.delay = self.dice.pick(&[0, 1, 1, 1, 2, 3, 4]);
        let mut text = format!(
            "rate_hz = {:?}\ndelay_samples = {}\nform = \"positions\"\n",
            self.rate, self.delay
        );
        self.tag("positions");
        self.tag(&format!("{} Hz", self.rate));
        self.tag(&format!("delay {}", self.delay));
        if self.dice.chance(0.35) {
            text += "preview = false\n";
            self.tag("no preview");
        }
        if self.dice.chance(0.3) {
            text += "torque_max_nm = \"none\"\n";
        }
        if self.dice.chance(0.15) {
            self.tag("rate limit");
            let rate = self.rate;
            let each = |torque: &f64| rate * torque.max(1e-3);
            let rates: Vec<f64> = self.even_torques(0.03, 1.0).iter().map(each).collect();
            let _ = writeln!(text, "torque_rate_max_nm_s = {rates:?}");
        }
        text
    }

    /// `[sensor]`: the law hears no velocity, whatever the study says of it.
    pub(crate) fn positions_sensor(&mut self) -> String {
        let mut text = String::new();
        if self.dice.chance(0.08) {
            self.tag("exact");
        } else {
            let even = self.dice.pick(&[16, 17, 18, 18, 19, 20]);
            let own = self.dice.chance(0.3);
            let bits = |hand: &mut Self| {
                if own { hand.dice.pick(&[16, 17, 18, 19, 20]) } else { even }
            };
            let bits: Vec<u32> = (0..self.count()).map(|_| bits(self)).collect();
            let _ = writeln!(text, "encoder_bits = {bits:?}");
        }
        if self.dice.chance(0.5) {
            text += "velocity = \"differenced\"\n";
        }
        if self.dice.chance(0.08) {
            text += &self.bias();
        }
        if self.dice.chance(0.1) {
            text += "torque = \"demanded\"\n";
            self.tag("demanded");
        }
        text
    }

    /// `[design]`, without the scope.
    pub(crate) fn positions_design(&mut self) -> String {
        let mut text = self.design();
        if self.dice.chance(0.6) {
            self.tag("torque step");
            let steps: Vec<f64> =
                self.even_torques(2e-3, 0.1).iter().map(|step| step.max(1e-4)).collect();
            let _ = writeln!(text, "torque_step_max_nm = {steps:?}");
        }
        text
    }

    /// Source of laws from positions. Most are typed: a search takes a hundred times as long as a tube of
    /// typed laws. One in five of the searched ones is a whole design.
    pub(crate) fn laws(&mut self, searched: f64) -> DraftLaws {
        let share = self.dice.share();
        if share >= searched {
            let gains = self.typed();
            let filter = seed(&gains);
            if filter.is_some() {
                self.tag("filtered");
            }
            return DraftLaws::Typed { gains, filter };
        }
        if share < 0.2 * searched {
            self.tag("designed");
            return DraftLaws::Designed;
        }
        self.tag("sketched");
        let loud = self.dice.log_between(0.02, 1.0);
        let even = self.dice.chance(0.4);
        let one = |dice: &mut Dice| if even { loud } else { loud * dice.between(0.5, 1.0) };
        DraftLaws::Sketched((0..self.count()).map(|_| one(self.dice)).collect())
    }

    /// `[gains]`, typed by a hand that knows the arm a little.
    fn typed(&mut self) -> String {
        self.tag("typed");
        let n = self.count();
        let off = self.dice.pick(&[0.05, 0.2, 0.5]);
        let inertia: Vec<f64> =
            self.middling().iter().map(|m| m * self.dice.between(-off, off).exp()).collect();
        // What is slow enough for delay and rate; each joint its own, or all alike.
        let slow = self.rate / (1.0 + 0.5 * f64::from(self.delay));
        let (outer, inner) =
            (slow * self.dice.log_between(0.008, 0.05), self.dice.log_between(2.0, 12.0));
        let apart = self.dice.pick(&[0.0, 0.15, 0.4]);
        let mut each = |middle: f64, most: f64| -> Vec<f64> {
            let one = |dice: &mut Dice| (middle * dice.between(-apart, apart).exp()).min(most);
            (0..n).map(|_| one(self.dice)).collect()
        };
        let below = 0.95 * PI * self.rate;
        let bandwidth = each(outer, below);
        let estimator = each(outer * inner, below);
        let turned = each(self.rate * 0.2, 1e5);
        let damping = self.dice.between(0.8, 2.5);
        let order: Vec<u32> = if self.dice.chance(0.5) {
            vec![self.dice.pick(&[1, 1, 2, 3]); n]
        } else {
            (0..n).map(|_| self.dice.pick(&[1, 2, 3])).collect()
        };
        let mut text = format!(
            "\n[gains]\ninertia_kg_m2 = {inertia:?}\norder = {order:?}\nbandwidth_rad_s = {bandwidth:?}\n\
             damping = {damping:?}\nestimator_bandwidth_rad_s = {estimator:?}\nestimator_damping = {:?}\n",
            self.dice.between(0.7, 1.2)
        );
        if self.dice.chance(0.7) {
            let _ = writeln!(text, "torque_bandwidth_hz = {turned:?}");
            self.tag("torque bandwidth");
        }
        text
    }

    /// A torque per joint, none of them nothing.
    fn even_torques(&mut self, low: f64, high: f64) -> Vec<f64> {
        let factor = self.dice.log_between(low, high);
        self.robot.joints.iter().map(|j| factor * j.torque_max.unwrap_or(20.0)).collect()
    }

    /// Geometric means of the joints' inertia over some postures.
    fn middling(&mut self) -> Vec<f64> {
        let model = self.robot.plant_model();
        let mut workspace = Workspace::new(&model);
        let n = self.count();
        let mut logs = vec![0.0; n];
        for _ in 0..POSTURES {
            let q = self.posture();
            let mut entries = vec![0.0; n * n];
            model.mass_matrix(&mut workspace, &q, &mut entries);
            let rows: Vec<Vec<f64>> = entries.chunks(n).map(<[f64]>::to_vec).collect();
            let free = inverse(&rows);
            for (i, log) in logs.iter_mut().enumerate() {
                // With the other joints held, and with them free.
                let held = rows[i][i];
                let free = free.as_ref().map_or(held, |free| 1.0 / free[i][i]);
                *log += (held * free).max(1e-18).ln() / (2.0 * POSTURES as f64);
            }
        }
        logs.iter().map(|log| log.exp()).collect()
    }
}
