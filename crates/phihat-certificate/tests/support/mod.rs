//! Studies, their tubes, and their runs in the simulator.
#![allow(dead_code, reason = "each test file uses its part")]

use std::path::Path;

use phihat::{JointDesign, JointGains};
use phihat_certificate::tube::{TubeInputs, TubeReference, TubeRefusal, derive};
use phihat_certificate::{JointRecord, Tube};
use phihat_sim::{Motion, Simulation, Trace};
use phihat_study::PayloadSet;
use phihat_study::{LawRequest, Study};

/// A study with its laws and its reference.
pub(crate) struct Case {
    pub(crate) text: String,
    pub(crate) study: Study,
    pub(crate) laws: Vec<JointRecord>,
    pub(crate) filter: Option<f64>,
    pub(crate) reference: TubeReference,
    pub(crate) payload: Option<PayloadSet>,
    pub(crate) coulomb: (Vec<f64>, Vec<f64>),
}

pub(crate) fn read(text: &str) -> Study {
    let base = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/support");
    Study::from_text(text, "test.toml", &base).unwrap_or_else(|e| panic!("{e}\n{text}"))
}

/// Samples of the motion.
pub(crate) fn reference(study: &Study) -> TubeReference {
    let motion = Motion::of(study).unwrap();
    let n = study.robot.joints.len();
    let period_ns = study.control.period_ns;
    #[allow(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a moderate positive number"
    )]
    let samples = (study.duration * 1e9 / period_ns as f64).round() as u64;
    let mut out = TubeReference::default();
    for k in 0..=samples {
        let t = (k * period_ns) as f64 * 1e-9;
        let jets: Vec<_> = (0..n).map(|i| motion.told(i, t)).collect();
        out.q.push(jets.iter().map(|j| j[0]).collect());
        out.dq.push(jets.iter().map(|j| j[1]).collect());
        out.ddq.push(jets.iter().map(|j| j[2]).collect());
    }
    out
}

impl Case {
    /// A study whose `[gains]` are typed as coefficients.
    pub(crate) fn new(text: &str) -> Self {
        let study = read(text);
        let gains = study.gains.as_ref().unwrap();
        let LawRequest::Coefficients { kp, kd, a } = &gains.law else { panic!("coefficients") };
        let law = |i: usize| JointRecord {
            name: study.robot.joints[i].name.clone(),
            inertia_kg_m2: gains.inertia[i],
            kp_per_s2: kp[i],
            kd_per_s: kd[i],
            a: a.clone(),
            observer: None,
        };
        let n = study.robot.joints.len();
        let laws = (0..n).map(law).collect();
        Self::with(text, laws, study.sensor.velocity_filter_hz)
    }

    pub(crate) fn with(text: &str, laws: Vec<JointRecord>, filter: Option<f64>) -> Self {
        let study = read(text);
        let reference = reference(&study);
        let own = |i: usize| {
            let joint = study.robot.joints[i].friction.coulomb;
            study.world.extra_coulomb[i] + if study.world.robot_friction { joint } else { 0.0 }
        };
        let levels: Vec<f64> = (0..laws.len()).map(own).collect();
        Self {
            text: text.to_owned(),
            reference,
            laws,
            filter,
            payload: None,
            coulomb: (levels.clone(), levels),
            study,
        }
    }

    pub(crate) fn derive(&self) -> Result<Tube, TubeRefusal> {
        self.inputs(|inputs| derive(inputs, &|_| ()))
    }

    pub(crate) fn inputs<R>(&self, of: impl FnOnce(&TubeInputs<'_>) -> R) -> R {
        of(&TubeInputs {
            study: &self.study,
            joints: &self.laws,
            velocity_filter_hz: self.filter,
            reference: &self.reference,
            payload: self.payload.as_ref(),
            slices: 1,
            coulomb: (&self.coulomb.0, &self.coulomb.1),
            bin_s: 0.01,
        })
    }

    /// A run with another payload, level of friction and encoder phase. The phase shifts start, motion and
    /// arm alike: it is the place of the encoder's zero.
    pub(crate) fn run(&self, draw: &Draw) -> Trace {
        let mut study = self.study.clone();
        study.sensor.velocity_filter_hz = self.filter;
        for (i, level) in draw.coulomb.iter().enumerate() {
            let own = study.robot.joints[i].friction.coulomb;
            let own = if study.world.robot_friction { own } else { 0.0 };
            study.world.extra_coulomb[i] = level - own;
        }
        if let Some((mass, com)) = draw.payload {
            let frame = self.payload.as_ref().unwrap().frame.clone();
            study.world.payload = Some(phihat_study::Payload {
                frame,
                mass,
                com,
                inertia: draw.inertia,
                start: 0.0,
                end: f64::INFINITY,
            });
        }
        let period = study.control.period_ns as f64 * 1e-9;
        let form = study.control.form;
        let gains: Vec<JointGains<f64>> = self
            .laws
            .iter()
            .map(|l| {
                let (inertia, kp, kd, a) = (l.inertia_kg_m2, l.kp_per_s2, l.kd_per_s, &l.a[..]);
                JointGains::new(&JointDesign { inertia, kp, kd, a, period, form }).unwrap()
            })
            .collect();
        // Other encoder phases: the same motion from a start that is off by less than nothing is not
        // the same study; instead the encoder's grid is moved through its bits.
        assert!(!draw.start.iter().any(|x| x.abs() > 0.0), "phases are drawn through `bits`");
        let outcome = Simulation::new(&study, &gains).unwrap().run(|_| ());
        assert!(outcome.divergence.is_none(), "the run diverged");
        outcome.trace
    }
}

/// Payload, friction and start of one run.
#[derive(Debug, Clone, Default)]
pub(crate) struct Draw {
    pub(crate) payload: Option<(f64, [f64; 3])>,
    pub(crate) inertia: [f64; 6],
    pub(crate) coulomb: Vec<f64>,
    pub(crate) start: Vec<f64>,
}

/// Largest share of the tube's half width that a run uses, per joint; more than 1: it left. Then the ratio
/// of the tube's largest error to the run's, after settling.
#[derive(Debug, Clone)]
pub(crate) struct Held {
    pub(crate) outside: f64,
    pub(crate) error_peak: Vec<f64>,
    pub(crate) velocity_max: Vec<f64>,
}

/// Holds a run against a tube; `outside` is how far it left \[rad or rad/s\], negative: inside.
pub(crate) fn hold(tube: &Tube, trace: &Trace) -> Held {
    let period = trace.period_ns as f64 * 1e-9;
    #[allow(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a moderate positive number"
    )]
    let per_bin = (tube.bin_s / period).round() as usize;
    let mut outside = f64::NEG_INFINITY;
    let (mut error_peak, mut velocity_max) = (Vec::new(), Vec::new());
    for (joint, bound) in trace.joints.iter().zip(&tube.joints) {
        let (mut most, mut fastest) = (0.0_f64, 0.0_f64);
        for k in 0..joint.e.len() {
            let b = k / per_bin;
            let (e, de) = (joint.e[k], joint.de[k]);
            outside = outside
                .max(bound.error_low_rad[b] - e)
                .max(e - bound.error_high_rad[b])
                .max(bound.velocity_low_rad_s[b] - de)
                .max(de - bound.velocity_high_rad_s[b]);
            if k as f64 * period >= tube.settle_s {
                most = most.max(e.abs());
                fastest = fastest.max(de.abs());
            }
        }
        let torque = joint.tau_command.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        let mut step = joint.tau_command[0].abs();
        for pair in joint.tau_command.windows(2) {
            step = step.max((pair[1] - pair[0]).abs());
        }
        outside = outside.max(torque - bound.torque_max_nm).max(step - bound.torque_step_max_nm);
        error_peak.push(most);
        velocity_max.push(fastest);
    }
    Held { outside, error_peak, velocity_max }
}
