//! Record of a watch: contacts, payloads, and the forces that it cannot miss.

use serde::{Deserialize, Serialize};

/// Result of a watch over a run.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct ContactRecord {
    /// Samples at which torques were compared with the model.
    pub watched_samples: u64,
    /// Time at which the watch ended before the run, and why; `None`: it did not.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ended: Option<(f64, String)>,
    /// Contacts, in the order of time; the first 64.
    pub events: Vec<ContactEvent>,
    /// Bodies at the payload's frame, each for as long as it explains all torques.
    pub payloads: Vec<PayloadEstimate>,
    /// Forces that cannot stay unnoticed; `None`: the arm has no tip, or nothing was watched for long enough.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reach: Option<ContactReach>,
}

/// A torque beyond what the certificate's model explains.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ContactEvent {
    /// Time of the sample that shows it \[s\].
    pub t_s: f64,
    /// Time of the last sample that showed it \[s\].
    pub until_s: f64,
    /// The joint that shows it first.
    pub joint: String,
    /// Torque beyond the interval of the model there \[N·m\] (N for a joint that slides), positive along the axis.
    pub beyond_nm: f64,
    /// Force at the tip \[N\], base axes, that comes nearest to the torques of all joints, once a whole window is
    /// about it; `None`: none explains them within their intervals.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub force_n: Option<[f64; 3]>,
}

/// Bodies that explain every torque of a part of a run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PayloadEstimate {
    /// Frame (link) that they are welded to.
    pub frame: String,
    /// Part of the run \[s\].
    pub from_s: f64,
    /// Its end \[s\].
    pub to_s: f64,
    /// Interval of the mass \[kg\].
    pub mass_kg: (f64, f64),
    /// Intervals of the centre of mass \[m\], axes of the frame.
    pub com_m: [(f64, f64); 3],
    /// Time from which on the mass is known to 5 % or 30 g \[s\]; `None`: it is not.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub known_s: Option<f64>,
}

/// Smallest constant force at the tip that no window can miss \[N\].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ContactReach {
    /// The tip's frame (link).
    pub frame: String,
    /// Length of the window \[s\]: such a force shows after it at the latest.
    pub within_s: f64,
    /// Along x, y, z of the base: the largest over the run; `None`: no joint feels such a force.
    pub always_n: [Option<f64>; 3],
    /// The same: the mean over the run.
    pub mean_n: [Option<f64>; 3],
    /// Along the worst of 13 directions and the worst time.
    pub worst_n: Option<f64>,
    /// Along the worst direction of each time: the mean over the run.
    pub worst_mean_n: Option<f64>,
}

impl ContactEvent {
    /// In a sentence: `contact at t = 3.036 s: panda_joint4, 1.20 N·m beyond the model; 5.1 N at the tip (…)`.
    pub fn sentence(&self) -> String {
        let Self { t_s, joint, beyond_nm, .. } = self;
        let force = self.force_n.map_or_else(String::new, |force| {
            let size = libm::sqrt(force.iter().map(|f| f * f).sum());
            let [x, y, z] = force;
            format!("; as {size:.1} N at the tip would, ({x:.1}, {y:.1}, {z:.1}) in base axes")
        });
        format!("contact at t = {t_s:.3} s: {joint}, {beyond_nm:+.2} N·m beyond the model{force}")
    }
}

impl PayloadEstimate {
    /// In a sentence: `payload on panda_link8 from 0.1 s to 10 s: 0.478 … 0.512 kg, …`.
    pub fn sentence(&self) -> String {
        let Self { frame, from_s, to_s, mass_kg: (low, high), com_m, known_s } = self;
        let [x, y, z] = com_m.map(|(a, b)| format!("{:.0} … {:.0}", 1e3 * a, 1e3 * b));
        let known = known_s.map_or_else(
            || "; not known to 5 % or 30 g".to_owned(),
            |t| format!("; known to 5 % or 30 g from t = {t:.2} s on"),
        );
        format!(
            "payload on {frame} from {from_s:.2} s to {to_s:.2} s: {low:.3} … {high:.3} kg, centre of mass in \
             {x} × {y} × {z} mm{known}"
        )
    }
}

impl ContactReach {
    /// In a sentence.
    pub fn sentence(&self) -> String {
        let of = |force: Option<f64>| force.map_or_else(|| "∞".to_owned(), |f| format!("{f:.1}"));
        let ([x, y, z], [mx, my, mz]) = (self.always_n.map(of), self.mean_n.map(of));
        format!(
            "a force at {} shows within {:.0} ms wherever it is above {x}, {y}, {z} N along x, y, z of the base (mean \
             {mx}, {my}, {mz} N; any direction {} N, mean {} N)",
            self.frame,
            1e3 * self.within_s,
            of(self.worst_n),
            of(self.worst_mean_n)
        )
    }
}
