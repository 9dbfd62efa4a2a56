//! What of a study the claims leave out.

use phihat_study::Study;
use serde::{Deserialize, Serialize};

/// Something in a study that the claims leave out. The law's linear loop is as certified all the same.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct NotCounted {
    /// Its key in the study.
    pub key: String,
    /// Its value there.
    pub value: String,
    /// Which claims do not count it.
    pub claims: LeftOut,
}

/// Which claims leave something out.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum LeftOut {
    /// Bounds on the error; the loop stays the one whose stability is claimed.
    Bounds,
    /// Bounds and stability: while it acts, the loop is another one.
    BoundsAndStability,
}

impl NotCounted {
    /// Everything in a study that claims about its gains leave out. Where this is empty and nothing is refused, the
    /// bounds are about the study as it runs.
    pub fn of(study: &Study) -> Vec<Self> {
        let mut list = List(Vec::new());
        list.sensor(study);
        list.drive(study);
        list.world(study);
        list.interface(study);
        for fault in &study.faults {
            let value = format!("{} from {} s", fault.kind.word(), fault.start);
            list.add("fault.kind", value, LeftOut::BoundsAndStability);
        }
        list.0
    }
}

struct List(Vec<NotCounted>);

impl List {
    fn add(&mut self, key: &str, value: String, claims: LeftOut) {
        self.0.push(NotCounted { key: key.to_owned(), value, claims });
    }

    /// A list in which a value differs from the one that is counted; one number where all are the same.
    fn values(&mut self, key: &str, values: &[f64], counted: f64) {
        if values.iter().any(|value| (value - counted).abs() > 0.0) {
            let same = values.windows(2).all(|pair| pair[0].to_bits() == pair[1].to_bits());
            let text = if same { format!("{}", values[0]) } else { format!("{values:?}") };
            self.add(key, text, LeftOut::Bounds);
        }
    }

    fn sensor(&mut self, study: &Study) {
        let sensor = &study.sensor;
        self.values("sensor.position_noise_rad", &sensor.position_noise, 0.0);
        self.values("sensor.position_bias_rad", &sensor.position_bias, 0.0);
        self.values("sensor.velocity_noise_rad_s", &sensor.velocity_noise, 0.0);
        self.values("sensor.torque_noise_nm", &sensor.torque_noise, 0.0);
        if sensor.wrap {
            self.add("sensor.wrap", "true".to_owned(), LeftOut::Bounds);
        }
    }

    fn drive(&mut self, study: &Study) {
        let Some(drive) = &study.world.drive else { return };
        self.values("world.drive.gain", &drive.gain, 1.0);
        self.values("world.drive.gain_error", &drive.gain_error, 0.0);
        self.values("world.drive.gain_drift_per_s", &drive.gain_drift, 0.0);
        self.values("world.drive.ripple", &drive.ripple, 0.0);
        self.values("world.drive.cogging_nm", &drive.cogging, 0.0);
        let limits = [
            ("world.drive.torque_max_nm", &drive.torque_max),
            ("world.drive.torque_rate_max_nm_s", &drive.torque_rate_max),
            ("world.drive.no_load_speed_rad_s", &drive.no_load_speed),
        ];
        for (key, limit) in limits {
            if let Some(limit) = limit {
                // The law does not see this limit: while it acts, nothing is claimed.
                self.add(key, format!("{limit:?}"), LeftOut::BoundsAndStability);
            }
        }
    }

    fn world(&mut self, study: &Study) {
        let world = &study.world;
        self.values("world.friction_cold_factor", &[world.warm_up.0], 1.0);
        if let Some(stiction) = &world.stiction {
            let text = format!("{:?}", stiction.breakaway_ratio);
            self.add("world.stiction.breakaway_ratio", text, LeftOut::Bounds);
        }
        if let Some(stops) = &world.end_stops {
            let text = format!("{:?}", stops.stiffness);
            self.add("world.end_stops.stiffness_nm_rad", text, LeftOut::BoundsAndStability);
        }
        for wall in &world.walls {
            let text = format!("{}", wall.stiffness);
            self.add("world.wall.stiffness_n_m", text, LeftOut::BoundsAndStability);
        }
        for force in &world.forces {
            let text = format!("{:?} from {} s", force.force, force.start);
            self.add("world.push.force_n", text, LeftOut::Bounds);
        }
        let comes_and_goes = |p: &&phihat_study::Payload| p.start > 0.0 || p.end.is_finite();
        if let Some(payload) = world.payload.as_ref().filter(comes_and_goes) {
            let text = format!("{} kg from {} s to {} s", payload.mass, payload.start, payload.end);
            self.add("world.payload", text, LeftOut::Bounds);
        }
        let losses = [
            ("world.network.command_loss", world.network.command.share),
            ("world.network.sample_loss", world.network.sample.share),
        ];
        for (key, share) in losses.into_iter().filter(|(_, share)| *share > 0.0) {
            self.add(key, format!("{share}"), LeftOut::BoundsAndStability);
        }
    }

    fn interface(&mut self, study: &Study) {
        let profile = &study.interface.profile;
        if profile.name != "ideal" {
            // Its help with gravity and friction, its clamps and rules; what it adds lies outside of the loop.
            self.add("profile.name", profile.name.clone(), LeftOut::Bounds);
        }
    }
}
