//! Scope of the tube, and its refusals.

use phihat_model::Sigmoid;
use phihat_study::Study;

use phihat_study::PayloadSet;

use super::number::Ball;
use crate::NotCounted;

/// Why there is no tube: one variant per reason.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ScopeRefusal {
    /// Something in the study acts that the derivation does not know.
    #[error("the tube does not count {what}")]
    NotCounted {
        /// Name of the effect, in words or as a study's key.
        what: String,
    },
    /// Lengths, counts or figures that do not belong together.
    #[error("{what} does not fit the study")]
    Mismatch {
        /// Name of the input that does not fit.
        what: &'static str,
    },
    /// The arm is not serial.
    #[error("the arm branches: only serial arms are derived")]
    Branches,
    /// The payload's frame is not there or not moved by the arm.
    #[error("the payload's frame is not moved by the arm")]
    PayloadFrame,
    /// The nominal run itself goes away.
    #[error("the nominal run diverges at {t:.3} s")]
    NominalDiverges {
        /// When \[s\].
        t: f64,
    },
    /// The mass matrix cannot be inverted, or moves too fast for the sample period.
    #[error("the linearised arm is too fast for the sample period at {t:.3} s")]
    TooFast {
        /// When \[s\].
        t: f64,
    },
    /// The bounds feed on each other.
    #[error("the tube does not close at {t:.3} s: {joint} may be off by more than {width:.3} rad")]
    Open {
        /// When \[s\].
        t: f64,
        /// The widest joint.
        joint: String,
        /// Half its width \[rad\] when it was given up.
        width: f64,
    },
    /// A torque limit or a rate limit could act: the loop is then another one.
    #[error("a limit can act at {t:.3} s on {joint}")]
    LimitCanAct {
        /// When \[s\].
        t: f64,
        /// Joint name.
        joint: String,
    },
}

/// Smooth friction of a joint: viscous and identified.
#[derive(Debug, Clone, Copy)]
pub(super) struct Smooth {
    viscous: f64,
    sigmoid: Option<Sigmoid>,
}

impl Smooth {
    pub(super) fn torque(&self, v: f64) -> f64 {
        self.viscous * v + self.sigmoid.as_ref().map_or(0.0, |law| law.torque(v))
    }

    pub(super) fn slope(&self, v: f64) -> f64 {
        let of = |law: &Sigmoid| {
            let z = logistic(law.steepness_s_rad * (v + law.offset_rad_s));
            law.amplitude_nm * law.steepness_s_rad * z * (1.0 - z)
        };
        self.viscous + self.sigmoid.as_ref().map_or(0.0, of)
    }

    /// The slope while the velocity is in a ball.
    pub(super) fn slope_over(&self, v: Ball) -> Ball {
        Ball { m: self.slope(v.m), r: self.bend(v.m - v.r, v.m + v.r) * v.r }
    }

    /// Largest size of the slope's slope where `low ≤ v ≤ high`: `a s² |z(1−z)(1−2z)|`, at most
    /// `a s²/(6√3)`, there at `|s (v + o)| = ln(2+√3)`.
    pub(super) fn bend(&self, low: f64, high: f64) -> f64 {
        let Some(law) = &self.sigmoid else { return 0.0 };
        let s = law.steepness_s_rad;
        let size = |x: f64| {
            let z = logistic(x);
            (z * (1.0 - z) * (1.0 - 2.0 * z)).abs()
        };
        let (a, b) = (s * (low + law.offset_rad_s), s * (high + law.offset_rad_s));
        let (a, b) = (a.min(b), a.max(b));
        let peak = libm::log(2.0 + 3.0_f64.sqrt());
        let mut most = size(a).max(size(b));
        for x in [-peak, peak] {
            if a <= x && x <= b {
                most = most.max(size(x));
            }
        }
        (law.amplitude_nm * s * s).abs() * most
    }
}

fn logistic(x: f64) -> f64 {
    1.0 / (1.0 + libm::exp(-x))
}

/// Smooth friction of every joint.
pub(super) fn smooth(study: &Study) -> Vec<Smooth> {
    let of = |(i, joint): (usize, &phihat_model::Joint)| {
        let own = study.world.robot_friction;
        Smooth {
            viscous: study.world.extra_viscous[i] + if own { joint.friction.viscous } else { 0.0 },
            sigmoid: joint.friction.sigmoid.filter(|_| own),
        }
    };
    study.robot.joints.iter().enumerate().map(of).collect()
}

/// Torque that the robot adds to a command by itself: at a sample, constant over it.
#[derive(Debug, Clone, Default)]
pub(super) struct AddedTorques {
    /// Gravity of the bare arm.
    pub(super) gravity: bool,
    /// A share of the robot's own smooth friction, joint by joint.
    pub(super) friction: Option<Vec<Smooth>>,
    /// And of its dry friction \[N·m\]; empty without.
    pub(super) dry: Vec<f64>,
}

impl AddedTorques {
    pub(super) fn of(study: &Study) -> Self {
        let profile = &study.interface.profile;
        let share = profile.adds_friction;
        if share <= 0.0 {
            return Self { gravity: profile.adds_gravity, ..Self::default() };
        }
        let own = |joint: &phihat_model::Joint| Smooth {
            viscous: share * joint.friction.viscous,
            sigmoid: joint
                .friction
                .sigmoid
                .map(|law| Sigmoid { amplitude_nm: share * law.amplitude_nm, ..law }),
        };
        let joints = &study.robot.joints;
        Self {
            gravity: profile.adds_gravity,
            friction: Some(joints.iter().map(own).collect()),
            dry: joints.iter().map(|joint| share * joint.friction.coulomb).collect(),
        }
    }

    /// Torque at a velocity, dry friction as the nominal run has it.
    pub(super) fn friction(&self, i: usize, v: f64, dry: &DryLevels) -> f64 {
        let smooth = self.friction.as_ref().map_or(0.0, |own| own[i].torque(v));
        smooth + self.dry.get(i).map_or(0.0, |level| level * dry.wide(v))
    }
}

/// Velocity over which the simulated dry friction turns \[rad/s\].
const TURN: f64 = 1e-3;

/// Dry friction: levels of each joint, and how the nominal run has it.
#[derive(Debug, Clone)]
pub(super) struct DryLevels {
    pub(super) low: Vec<f64>,
    pub(super) high: Vec<f64>,
    pub(super) middle: Vec<f64>,
    /// Velocity over which the nominal friction turns \[rad/s\].
    pub(super) turn: f64,
}

#[allow(clippy::imprecise_flops, reason = "as the simulator has it")]
impl DryLevels {
    pub(super) fn sign(v: f64) -> f64 {
        v / (v * v + TURN * TURN).sqrt()
    }

    pub(super) fn wide(&self, v: f64) -> f64 {
        v / (v * v + self.turn * self.turn).sqrt()
    }
}

/// Parts of the mass from which on the box of centres is divided too.
pub(super) const FINE: u32 = 4;

/// Both halves of a box across its widest side; the box itself, where it is a point.
fn across(com: [(f64, f64); 3]) -> Vec<[(f64, f64); 3]> {
    let width = |axis: &usize| com[*axis].1 - com[*axis].0;
    let widest = (1..3).fold(0, |best, axis| if width(&axis) > width(&best) { axis } else { best });
    if width(&widest) <= 0.0 {
        return vec![com];
    }
    let (low, high) = com[widest];
    let middle = 0.5 * (low + high);
    [(low, middle), (middle, high)]
        .map(|half| {
            let mut part = com;
            part[widest] = half;
            part
        })
        .to_vec()
}

/// A payload set whose mass, and box of centres, are parts of the whole.
#[derive(Debug, Clone)]
pub(super) struct PayloadSlice {
    pub(super) frame: String,
    pub(super) mass: (f64, f64),
    /// Middle and half width of the box of centres of mass \[m\].
    pub(super) centre: [f64; 3],
    pub(super) reach: [f64; 3],
    pub(super) gyration: f64,
}

impl PayloadSlice {
    /// The set in `parts` equal parts of the mass; from [`FINE`] of them on, the centres' box is halved
    /// across its widest side too.
    pub(super) fn all(set: &PayloadSet, parts: u32) -> Vec<Self> {
        let (low, high) = set.mass;
        let at = |i: u32| low + (high - low) * f64::from(i) / f64::from(parts);
        let boxes = if parts >= FINE { across(set.com) } else { vec![set.com] };
        let one = |i: u32, com: &[(f64, f64); 3]| Self {
            frame: set.frame.clone(),
            mass: (at(i), if i + 1 == parts { high } else { at(i + 1) }),
            centre: com.map(|(a, b)| 0.5 * (a + b)),
            reach: com.map(|(a, b)| 0.5 * (b - a)),
            gyration: set.gyration,
        };
        (0..parts).flat_map(|i| boxes.iter().map(move |com| one(i, com))).collect()
    }

    pub(super) fn middle(&self) -> f64 {
        0.5 * (self.mass.0 + self.mass.1)
    }

    /// Largest entries of the second moment about the centre, `xx yy zz xy xz yz`, per kilogram.
    pub(super) fn spread(&self) -> [f64; 6] {
        let ([x, y, z], g) = (self.reach, self.gyration * self.gyration);
        [x * x + g, y * y + g, z * z + g, x * y + g, x * z + g, y * z + g]
    }

    /// Largest and smallest value of a function that is linear in the ten moments about the centre, less its
    /// value for the nominal point: `slopes` by moment.
    pub(super) fn range(&self, slopes: &[f64; 10]) -> (f64, f64) {
        let of = |m: f64| {
            let first: f64 = (0..3).map(|i| self.reach[i] * slopes[1 + i].abs()).sum();
            let mut centre = (m - self.middle()) * slopes[0];
            let mut radius = m * first;
            for (i, most) in self.spread().into_iter().enumerate() {
                let slope = m * most * slopes[4 + i];
                if i < 3 {
                    centre += 0.5 * slope;
                    radius += 0.5 * slope.abs();
                } else {
                    radius += slope.abs();
                }
            }
            (centre - radius, centre + radius)
        };
        let (a, b) = (of(self.mass.0), of(self.mass.1));
        (a.0.min(b.0), a.1.max(b.1))
    }

    /// Largest deviation of each of the ten moments from the nominal point's.
    pub(super) fn most(&self) -> [f64; 10] {
        let high = self.mass.1;
        let mut out = [0.5 * (self.mass.1 - self.mass.0); 10];
        for i in 0..3 {
            out[1 + i] = high * self.reach[i];
        }
        for (out, spread) in out[4..].iter_mut().zip(self.spread()) {
            *out = high * spread;
        }
        out
    }

    /// Largest entries of the deviation of the 6×6 inertia about the centre, twist as `v, w`.
    pub(super) fn deviation(&self) -> [[f64; 6]; 6] {
        let high = self.mass.1;
        let [xx, yy, zz, xy, xz, yz] = self.spread().map(|s| high * s);
        let h = self.reach.map(|r| high * r);
        let mut d = [[0.0; 6]; 6];
        for i in 0..3 {
            d[i][i] = 0.5 * (self.mass.1 - self.mass.0);
        }
        for (a, b, c) in [(0, 1, 2), (1, 2, 0), (2, 0, 1)] {
            for (i, j) in [(a, b), (b, a)] {
                d[i][3 + j] = h[c];
                d[3 + i][j] = h[c];
            }
        }
        let turning = [[yy + zz, xy, xz], [xy, xx + zz, yz], [xz, yz, xx + yy]];
        for i in 0..3 {
            d[3 + i][3..].copy_from_slice(&turning[i]);
        }
        d
    }
}

/// Refuses a study with effects that are outside of the derivation.
pub(crate) fn counted(study: &Study) -> Result<(), ScopeRefusal> {
    let world = &study.world;
    let sensor = &study.sensor;
    let profile = &study.interface.profile;
    let any = |list: &[f64]| list.iter().any(|x| x.abs() > 0.0);
    let network = [world.network.command.share, world.network.sample.share];
    let carried = |p: &phihat_study::Payload| p.start > 0.0 || p.end < study.duration;
    let adds = profile.adds_gravity || profile.adds_friction > 0.0;
    let listed = [
        (world.stiction.is_some(), "stiction"),
        (world.flexibility.is_some(), "elastic transmissions"),
        (world.end_stops.is_some(), "end stops"),
        (!world.walls.is_empty(), "walls"),
        (!world.forces.is_empty(), "forces at a frame"),
        (world.drive.is_some(), "imperfect drives"),
        (any(&network), "lost messages"),
        ((world.warm_up.0 - 1.0).abs() > 0.0, "friction that warms up"),
        (world.payload.as_ref().is_some_and(carried), "a payload picked up or dropped"),
        (!study.faults.is_empty(), "faults"),
        (study.supervisor.is_some(), "the supervisor"),
        (any(&sensor.position_noise), "noise of the position"),
        (any(&sensor.velocity_noise), "noise of the velocity"),
        (any(&sensor.torque_noise), "noise of the torque"),
        (sensor.jitter > 0.0, "jitter"),
        (sensor.wrap, "positions that start over"),
        (profile.torque_filter.is_some(), "the robot's torque filter"),
        (adds && world.drive_bandwidth_hz.is_some(), "the lag of drives in what the robot adds"),
    ];
    if let Some((_, what)) = listed.into_iter().find(|(acts, _)| *acts) {
        return Err(ScopeRefusal::NotCounted { what: what.to_owned() });
    }
    // What is decided on field by field, for the certificate.
    match NotCounted::of(study).into_iter().find(|one| !one.in_tube()) {
        Some(one) => Err(ScopeRefusal::NotCounted { what: format!("`{}`", one.key) }),
        None => Ok(()),
    }
}
