//! The bound for a class, derived a second time: kicks played at the witnesses and at postures that nobody knew before.

use phihat_model::{Body, Model, Rotor, Workspace};
use phihat_study::{Held, Known, MotionClass, ReferenceRequest, Study};
use serde::Serialize;

use super::document::ClassBound;
use super::dynamics::Dynamics;
use super::sums::{E, KINDS, PlayedSums, STEP, V};
use crate::check::agree::agrees;
use crate::check::plausible::at_most;
use crate::extremes::Extremes as _;
use crate::loaded::loaded;
use crate::refutation::refuse;
use crate::{Certificate, Gains, JointRecord, LoopModel, Matrix, Refutation, TorqueNoise};

const CLAIM: &str = "class of motions";

/// Two ways to compute the same number.
const SAME: f64 = 1e-9;

/// Postures drawn from the file, beside its witnesses, and points at which torque rates are looked at.
const FRESH: usize = 8;
const POINTS: usize = 1500;

/// Samples for which a supervisor's start may be out of balance before the law acts, at least.
const BEFORE: f64 = 4.0;

/// Half the time over which a rate is a difference \[s\].
const MOMENT: f64 = 3e-5;

/// Iterations of the fixed point.
const ROUNDS: usize = 400;

/// A joint's bounds beside those that a second derivation gives.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct JointOfClass {
    /// Joint name.
    pub name: String,
    /// Bound on `|e|` in the file \[rad\].
    pub claimed_rad: f64,
    /// Bound on `|e|` derived here \[rad\].
    pub derived_rad: f64,
}

/// Result of a second derivation of a bound for a class.
///
/// # Method
///
/// Impulses and misreadings are played through the checker's own loop at the witnesses and at postures drawn from the
/// file's own text; Coriolis torque is taken from inverse dynamics, torque rates from points drawn likewise.
///
/// # Not claimed
///
/// Second derivatives of the dynamics, second-order terms in the error, and what comes after the played time are left
/// out, each of which only adds to a bound: the derived one is from below. A file with less is refuted.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ClassAgain {
    /// Joint by joint.
    pub joints: Vec<JointOfClass>,
    /// Postures at which kicks were played.
    pub postures: usize,
    /// Points of the class at which torque rates were looked at.
    pub points: usize,
}

impl ClassAgain {
    /// The least of claimed over derived: at 1 both agree, below 1 the file is refuted.
    pub fn least_ratio(&self) -> f64 {
        let ratio = |joint: &JointOfClass| joint.claimed_rad / joint.derived_rad;
        self.joints.iter().map(ratio).least()
    }
}

/// Numbers that a text decides.
struct PostureDice(u64);

impl PostureDice {
    fn of(text: &str) -> Self {
        let step = |hash: u64, byte: u8| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
        Self(text.bytes().fold(0xcbf2_9ce4_8422_2325, step))
    }

    /// From 0 up to 1.
    fn share(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn sign(&mut self) -> f64 {
        if self.share() < 0.5 { -1.0 } else { 1.0 }
    }

    /// Of a box, every second time a corner.
    fn place(&mut self, class: &MotionClass) -> Vec<f64> {
        let corner = self.share() < 0.5;
        let ends = class.low.iter().zip(&class.high);
        ends.map(|(low, high)| {
            let share = self.share();
            low + (high - low) * if corner { share.round() } else { share }
        })
        .collect()
    }
}

/// Maxima of torques over points of the class.
#[derive(Default)]
struct Maxima {
    /// Rate at constant acceleration; rate without the part in the acceleration; size of that part, and its rate by the
    /// jerk.
    whole: Vec<f64>,
    slow: Vec<f64>,
    size: Vec<f64>,
    jerk: Vec<f64>,
    /// Rate of what is fed forward.
    fed: Vec<f64>,
    /// Torque of gravity that the start leaves.
    start: Vec<f64>,
}

/// Scratch memory of the arm, of what is fed forward, of what the robot adds.
type Rooms = (Workspace<f64>, Workspace<f64>, Workspace<f64>);

/// The sums at a posture, and its matrix on errors by forces: `|M'' − D'|` as far as first derivatives go.
struct PlayedPosture {
    sums: PlayedSums,
    force: Matrix,
}

/// All that does not depend on a posture.
struct ClassSetting<'a> {
    n: usize,
    period: f64,
    class: &'a MotionClass,
    nominal: Vec<f64>,
    dry: Vec<f64>,
    slope: Vec<f64>,
    reading: Vec<f64>,
    fed: Option<(Model, bool)>,
    /// The arm whose torque of gravity the robot adds by itself.
    added: Option<Model>,
    /// Largest age of what is fed forward \[samples\].
    late: f64,
    start: Start,
}

/// Start of the law, as a study has it.
struct Start {
    /// True if a supervisor starts it.
    supervised: bool,
    /// Torque that it starts with \[N·m\].
    preset: Vec<f64>,
    /// Torque by which it is stated to be out of balance \[N·m\].
    stated: Option<Vec<f64>>,
}

impl Start {
    /// The arm starts in balance, on the reference, or a supervisor that leaves the law as it is starts it.
    fn of(study: &Study) -> Result<Self, Refutation> {
        let n = study.robot.joints.len();
        let Some(own) = &study.supervisor else {
            let balanced = study.world.held == Some(Held::InBalance) && study.world.start.is_none();
            let what = "the arm starts in balance, on the reference";
            Refutation::unless(CLAIM, what, 0.0, 1.0, balanced)?;
            return Ok(Self { supervised: false, preset: vec![0.0; n], stated: None });
        };
        let changed = own.dead_zone.is_some()
            || own.funnel.is_some()
            || own.soft_zone.is_some()
            || own.start_first_order
            || own.start_factor.is_some();
        let what = "the supervisor leaves the law as it is";
        Refutation::unless(CLAIM, what, 1.0, 0.0, !changed && study.feedforward.is_none())?;
        let preset = own.preset.clone().unwrap_or_else(|| vec![0.0; n]);
        Ok(Self { supervised: true, preset, stated: own.start_imbalance.clone() })
    }

    /// A start that nobody stated is as far out of balance as what is found here, at least.
    fn fits(
        &self,
        (maxima, claimed): (&Maxima, &ClassBound),
        study: &Study,
    ) -> Result<(), Refutation> {
        if !self.supervised || self.stated.is_some() {
            return Ok(());
        }
        let least = maxima.start.iter().zip(&study.design.coulomb.1);
        for ((left, dry), claimed) in least.zip(&claimed.start_nm) {
            at_most(CLAIM, "start out of balance ≤ claimed", left.max(*dry), *claimed)?;
        }
        Ok(())
    }
}

impl Certificate {
    /// Derives the bound for a class again, and holds the file's against it; `None`: the file has none.
    ///
    /// # Errors
    ///
    /// [`Refutation`]: it is about another study, or claims less than is derived here.
    pub fn derive_class(
        &self,
        gains: &Gains,
        study: &Study,
    ) -> Result<Option<ClassAgain>, Refutation> {
        let Some(claimed) = &self.class else { return Ok(None) };
        let ReferenceRequest::Any { class, .. } = &study.reference else {
            return Err(refuse(CLAIM, "the study's reference is a class of motions", 0.0, 1.0));
        };
        let models: Vec<LoopModel> = self.joints.iter().map(|joint| joint.model).collect();
        let setting = ClassSetting::of(study, gains, class, &models)?;
        setting.is_of(claimed, study)?;
        let text = gains.to_json().map_err(|why| refuse(CLAIM, &why.to_string(), 0.0, 0.0))?;
        let mut dice = PostureDice::of(&text);
        let bodies = bodies(study);
        let loops: Vec<(&JointRecord, &LoopModel)> = gains.joints.iter().zip(&models).collect();
        let mut all = Vec::new();
        for witness in &claimed.witnesses {
            let body = witness.payload.as_ref().map(|p| Body {
                mass: p.mass_kg,
                com: p.com_m,
                inertia: p.inertia_kg_m2,
            });
            let body = body.unwrap_or(Body { mass: 0.0, com: [0.0; 3], inertia: [0.0; 6] });
            let known = body.mass <= 0.0 || bodies.iter().any(|(_, own)| *own == body);
            Refutation::unless(CLAIM, "a witness carries a payload of the set", 0.0, 1.0, known)?;
            let frame = witness.payload.as_ref().map_or("", |p| p.frame.as_str());
            for rotor in rotors(study) {
                let model =
                    loaded(study, (*rotor, &body), frame)?.with_gravity(study.world.gravity);
                all.push(setting.played(&loops, &model, &witness.q_rad)?);
            }
        }
        for k in 0..FRESH {
            let (frame, body) = &bodies[k % bodies.len()];
            let rotors = rotors(study);
            let model = loaded(study, (rotors[k % rotors.len()], body), frame)?;
            let model = model.with_gravity(study.world.gravity);
            all.push(setting.played(&loops, &model, &dice.place(class))?);
        }
        let stated = bodies.iter().map(|(frame, body)| {
            Ok(loaded(study, (Rotor::Stated, body), frame)?.with_gravity(study.world.gravity))
        });
        let models: Vec<Model> = stated.collect::<Result<_, Refutation>>()?;
        let maxima = setting.maxima(&models, &mut dice);
        setting.start.fits((&maxima, claimed), study)?;
        let [error, velocity, step] = setting.solve(&all, &maxima, claimed)?;
        let lists = [
            ("derived |e| ≤ claimed", &error, &claimed.error_bound_rad),
            ("derived |ė| ≤ claimed", &velocity, &claimed.velocity_error_bound_rad_s),
            ("derived torque step ≤ claimed", &step, &claimed.torque_step_nm),
        ];
        for (what, derived, claimed) in lists {
            for ((derived, claimed), record) in derived.iter().zip(claimed).zip(&gains.joints) {
                at_most(CLAIM, what, *derived, *claimed).map_err(|why| why.on(&record.name))?;
            }
        }
        let joints = gains.joints.iter().zip(&claimed.error_bound_rad).zip(&error);
        let joints = joints.map(|((record, claimed), derived)| JointOfClass {
            name: record.name.clone(),
            claimed_rad: *claimed,
            derived_rad: *derived,
        });
        Ok(Some(ClassAgain { joints: joints.collect(), postures: all.len(), points: POINTS }))
    }
}

/// The payloads at the ends of the set, and the study's own.
fn bodies(study: &Study) -> Vec<(String, Body)> {
    let set = &study.design.payload;
    let mut all = vec![(set.frame.clone(), set.lightest())];
    all.extend(set.heaviest().into_iter().map(|body| (set.frame.clone(), body)));
    all.extend(study.world.payload.as_ref().map(|own| (own.frame.clone(), own.body())));
    all
}

fn rotors(study: &Study) -> &'static [Rotor] {
    if study.robot.has_rotor_interval() { &[Rotor::Least, Rotor::Most] } else { &[Rotor::Stated] }
}

/// Level of forces of any course \[N·m\] per joint: dry friction, pushes.
fn forces(study: &Study) -> Vec<f64> {
    let mut dry = study.design.coulomb.1.clone();
    for push in &study.world.pushes {
        dry[push.joint] += push.torque.abs();
    }
    dry
}

/// Model of what is fed forward, and true if that is gravity alone; its dry friction goes to the forces.
fn fed_forward(study: &Study, dry: &mut [f64]) -> Result<Option<(Model, bool)>, Refutation> {
    let Some(own) = &study.feedforward else { return Ok(None) };
    for (dry, level) in dry.iter_mut().zip(&own.coulomb) {
        *dry += level.abs();
    }
    if own.known == Known::Nothing {
        return Ok(None);
    }
    let model = study.robot.plant_model().with_gravity(study.world.gravity);
    let model = model.with_masses_times(own.mass_scale);
    let model = model.map_err(|why| refuse(CLAIM, &why.to_string(), 0.0, 0.0))?;
    Ok(Some((model, own.known == Known::Gravity)))
}

impl<'a> ClassSetting<'a> {
    fn of(
        study: &Study,
        gains: &Gains,
        class: &'a MotionClass,
        models: &[LoopModel],
    ) -> Result<Self, Refutation> {
        let n = class.center.len();
        Refutation::unless(
            CLAIM,
            "one law per joint",
            models.len() as f64,
            n as f64,
            models.len() == n,
        )?;
        let plain = models.iter().all(|m| {
            m.form == phihat::Form::Positions
                && m.drive_bandwidth_hz.is_none()
                && m.sample_delay_samples == 0
                && m.torque_filter_hz.is_none()
        });
        Refutation::unless(
            CLAIM,
            "laws from positions, no drive lag, no late sample, no torque filter",
            0.0,
            1.0,
            plain,
        )?;
        let start = Start::of(study)?;
        let profile = &study.interface.profile;
        let lone =
            profile.adds_friction <= 0.0 && !(profile.adds_gravity && study.feedforward.is_some());
        Refutation::unless(CLAIM, "nothing but gravity is added by the robot", 1.0, 0.0, lone)?;
        let delay = models.iter().map(|m| m.delay_samples).max().unwrap_or(0);
        let mut dry = forces(study);
        let fed = fed_forward(study, &mut dry)?;
        let slope = |i: usize| {
            let own = study.robot.joints[i].friction;
            let acts =
                if study.world.robot_friction { own } else { phihat_model::Friction::default() };
            // The logistic curve is steepest in its middle: a quarter of size times steepness.
            let bend =
                acts.sigmoid.map_or(0.0, |s| (s.amplitude_nm * s.steepness_s_rad).abs() / 4.0);
            acts.viscous.abs() + study.world.extra_viscous[i].abs() + bend
        };
        let bits = study.sensor.encoder_bits.as_deref();
        let reading = |i: usize| {
            let quantum = bits.map_or(0.0, |bits| TorqueNoise::quantum(bits[i]));
            0.5 * quantum + study.sensor.position_bias[i].abs()
        };
        Ok(Self {
            n,
            period: study.control.period_ns as f64 * 1e-9,
            class,
            nominal: gains.joints.iter().map(|joint| joint.inertia_kg_m2).collect(),
            slope: (0..n).map(slope).collect(),
            reading: (0..n).map(reading).collect(),
            dry,
            fed,
            added: profile
                .adds_gravity
                .then(|| study.robot.plant_model().with_gravity(study.world.gravity)),
            late: if start.supervised { f64::from(delay) + 1.0 } else { 0.5 },
            start,
        })
    }

    /// The file is about this study's class, forces, readings and payloads.
    fn is_of(&self, claimed: &ClassBound, study: &Study) -> Result<(), Refutation> {
        let class = self.class;
        let lists = [
            ("low ends of the box", &claimed.box_rad.0, &class.low),
            ("high ends of the box", &claimed.box_rad.1, &class.high),
            ("speed", &claimed.speed_max_rad_s, &class.speed),
            ("acceleration", &claimed.acceleration_max_rad_s2, &class.acceleration),
            ("jerk", &claimed.jerk_max_rad_s3, &class.jerk),
            ("forces", &claimed.force_nm, &self.dry),
            ("errors of readings", &claimed.reading_rad, &self.reading),
        ];
        for (what, own, right) in lists {
            for (own, right) in own.iter().zip(right) {
                agrees(CLAIM, &format!("{what} of the study"), (*own, *right), SAME)?;
            }
        }
        let same = claimed.is_supervised() == self.start.supervised;
        Refutation::unless(CLAIM, "a supervisor, as in the study", 1.0, 0.0, same)?;
        if self.start.supervised {
            let least = BEFORE * self.period;
            at_most(CLAIM, "time before the law ≤ claimed", least, claimed.start_s * (1.0 + SAME))?;
        }
        for (own, stated) in claimed.start_nm.iter().zip(self.start.stated.iter().flatten()) {
            agrees(CLAIM, "start out of balance, as stated", (*own, *stated), SAME)?;
        }
        let (own, set) = (&claimed.payload, &study.design.payload);
        let same = own.frame == set.frame && own.mass_kg == set.mass && own.com_m == set.com;
        let same = same && (own.gyration_m - set.gyration).abs() <= SAME * set.gyration;
        Refutation::unless(CLAIM, "payloads of the study", own.mass_kg.1, set.mass.1, same)
    }

    fn played(
        &self,
        loops: &[(&JointRecord, &LoopModel)],
        model: &Model,
        q: &[f64],
    ) -> Result<PlayedPosture, Refutation> {
        let dynamics = Dynamics::at(model, self.added.as_ref(), q);
        let inverse = crate::coupled::inverse(&dynamics.mass, self.n)?;
        let sums = PlayedSums::at(loops, (&dynamics, &inverse), self.period)?;
        let mut force = vec![vec![0.0; self.n]; self.n];
        for (c, a) in self.class.acceleration.iter().enumerate() {
            for (row, less) in force.iter_mut().zip(dynamics.less(c, 1.0)) {
                for (sum, entry) in row.iter_mut().zip(less) {
                    *sum += a * entry.abs();
                }
            }
        }
        Ok(PlayedPosture { sums, force })
    }

    /// Torque of a motion without friction, less what the robot adds, and of what is fed forward for it.
    fn torques(
        &self,
        model: &Model,
        rooms: &mut Rooms,
        (q, dq, ddq): (&[f64], &[f64], &[f64]),
    ) -> (Vec<f64>, Vec<f64>) {
        let mut tau = vec![0.0; self.n];
        model.inverse_dynamics(&mut rooms.0, q, dq, ddq, &mut tau);
        if let Some(bare) = &self.added {
            let (rest, mut weight) = (vec![0.0; self.n], vec![0.0; self.n]);
            bare.bias(&mut rooms.2, q, &rest, &mut weight);
            tau.iter_mut().zip(weight).for_each(|(tau, added)| *tau -= added);
        }
        let mut fed: Vec<f64> = self.nominal.iter().zip(ddq).map(|(m, a)| m * a).collect();
        match &self.fed {
            Some((own, true)) => {
                let (rest, mut still) = (vec![0.0; self.n], vec![0.0; self.n]);
                own.bias(&mut rooms.1, q, &rest, &mut still);
                fed.iter_mut().zip(still).for_each(|(fed, g)| *fed += g);
            }
            Some((own, false)) => own.inverse_dynamics(&mut rooms.1, q, dq, ddq, &mut fed),
            None => {}
        }
        (tau, fed)
    }

    /// Looks at points of the class, all of them corners of speed and acceleration.
    fn maxima(&self, models: &[Model], dice: &mut PostureDice) -> Maxima {
        let n = self.n;
        let zero = || vec![0.0_f64; n];
        let mut most = Maxima {
            whole: zero(),
            slow: zero(),
            size: zero(),
            jerk: zero(),
            fed: zero(),
            start: zero(),
        };
        let mut fed_jerk = zero();
        for k in 0..POINTS {
            let model = &models[k % models.len()];
            let own = self.fed.as_ref().map_or(model, |(own, _)| own);
            let bare = self.added.as_ref().unwrap_or(model);
            let mut rooms = (Workspace::new(model), Workspace::new(own), Workspace::new(bare));
            let q = dice.place(self.class);
            let dq: Vec<f64> = self.class.speed.iter().map(|v| v * dice.sign()).collect();
            let ddq: Vec<f64> = self.class.acceleration.iter().map(|a| a * dice.sign()).collect();
            let mut unknown = |t: f64, ddq_of: f64| -> (Vec<f64>, Vec<f64>) {
                let at = |i: usize| q[i] + t * dq[i] + 0.5 * t * t * ddq[i];
                let speed: Vec<f64> = (0..n).map(|i| dq[i] + t * ddq[i]).collect();
                let push: Vec<f64> = ddq.iter().map(|a| ddq_of * a).collect();
                let place: Vec<f64> = (0..n).map(at).collect();
                let (tau, fed) = self.torques(model, &mut rooms, (&place, &speed, &push));
                (tau.iter().zip(&fed).map(|(a, b)| a - b).collect(), fed)
            };
            let ends = [unknown(MOMENT, 1.0), unknown(-MOMENT, 1.0)];
            let slow = [unknown(MOMENT, 0.0), unknown(-MOMENT, 0.0)];
            let rate = |a: &[f64], b: &[f64], i: usize| ((a[i] - b[i]) / (2.0 * MOMENT)).abs();
            for i in 0..n {
                most.whole[i] = most.whole[i].max(rate(&ends[0].0, &ends[1].0, i));
                most.slow[i] = most.slow[i].max(rate(&slow[0].0, &slow[1].0, i));
                most.fed[i] = most.fed[i].max(rate(&ends[0].1, &ends[1].1, i));
            }
            // Every tenth point: what the acceleration and the jerk do by themselves.
            if k % 10 == 0 {
                for (i, [size, jerk, fed, start]) in
                    self.inertial(model, &mut rooms, &q).into_iter().enumerate()
                {
                    most.size[i] = most.size[i].max(size);
                    most.jerk[i] = most.jerk[i].max(jerk);
                    most.start[i] = most.start[i].max(start);
                    fed_jerk[i] = fed_jerk[i].max(fed);
                }
            }
        }
        most.fed.iter_mut().zip(fed_jerk).for_each(|(fed, jerk)| *fed += jerk);
        most
    }

    /// Of each joint at a posture: size and rate by the jerk of the part in the acceleration, rate by the jerk of what
    /// is fed forward, and what the start leaves of gravity.
    fn inertial(&self, model: &Model, rooms: &mut Rooms, q: &[f64]) -> Vec<[f64; 4]> {
        let n = self.n;
        let rest = vec![0.0; n];
        let (base, fed_base) = self.torques(model, rooms, (q, &rest, &rest));
        let left = base.iter().zip(&self.start.preset).map(|(held, preset)| (held - preset).abs());
        let mut sums: Vec<[f64; 4]> = left.map(|start| [0.0, 0.0, 0.0, start]).collect();
        for j in 0..n {
            let mut unit = vec![0.0; n];
            unit[j] = 1.0;
            let (tau, fed) = self.torques(model, rooms, (q, &rest, &unit));
            for i in 0..n {
                let fed = fed[i] - fed_base[i];
                let left = (tau[i] - base[i] - fed).abs();
                sums[i][0] += left * self.class.acceleration[j];
                sums[i][1] += left * self.class.jerk[j];
                sums[i][2] += fed.abs() * self.class.jerk[j];
            }
        }
        sums
    }

    /// The least solution over the postures: error, velocity, torque step.
    fn solve(
        &self,
        all: &[PlayedPosture],
        maxima: &Maxima,
        claimed: &ClassBound,
    ) -> Result<[Vec<f64>; KINDS], Refutation> {
        let n = self.n;
        let held: Vec<f64> = maxima.fed.iter().map(|rate| self.late * self.period * rate).collect();
        let begun = |own: &PlayedPosture, o: usize, i: usize| -> f64 {
            let starts = claimed.start_nm.iter().enumerate();
            let answers = starts.map(|(j, torque)| {
                torque * (own.sums.lasting[o][i][j] + claimed.start_s * own.sums.impulse[o][i][j])
            });
            answers.sum()
        };
        let along = |m: &Matrix, i: usize, x: &[f64]| -> f64 {
            m[i].iter().zip(x).map(|(m, x)| m * x).sum()
        };
        let output =
            |own: &PlayedPosture, o: usize, i: usize, error: &[f64], velocity: &[f64]| -> f64 {
                let sums = &own.sums;
                let mut torque = vec![0.0; n];
                let mut ramp = vec![0.0; n];
                for j in 0..n {
                    let (r, f) = (sums.ramp[E][j][j], sums.torque[E][j][j]);
                    let smooth = maxima.whole[j] + maxima.jerk[j];
                    let boxed = r * maxima.slow[j] + f * maxima.size[j] < r * smooth;
                    torque[j] = self.dry[j] + held[j] + self.slope[j] * velocity[j];
                    torque[j] += if boxed { maxima.size[j] } else { 0.0 };
                    ramp[j] = if boxed { maxima.slow[j] } else { smooth };
                    ramp[j] += self.slope[j] * self.class.acceleration[j];
                    if o == E {
                        torque[j] += along(&own.force, j, error);
                    }
                }
                let mut sum = along(&sums.torque[o], i, &torque)
                    + along(&sums.ramp[o], i, &ramp)
                    + along(&sums.reading[o], i, &self.reading)
                    + along(&sums.gravity[o], i, error)
                    + begun(own, o, i);
                for (c, speed) in self.class.speed.iter().enumerate() {
                    let moves = if o == E { error } else { velocity };
                    sum += speed * along(&sums.moving[o][c], i, moves);
                }
                sum
            };
        let most = |o: usize, i: usize, error: &[f64], velocity: &[f64]| {
            all.iter().map(|own| output(own, o, i, error, velocity)).largest()
        };
        let (mut error, mut velocity) = (vec![0.0; n], vec![0.0; n]);
        for _ in 0..ROUNDS {
            let next: Vec<f64> = (0..n).map(|i| most(E, i, &error, &velocity)).collect();
            let speed: Vec<f64> = (0..n).map(|i| most(V, i, &error, &velocity)).collect();
            let change = next.iter().zip(&error).map(|(a, b)| (a - b).abs() / a).largest();
            (error, velocity) = (next, speed);
            if !error.iter().all(|e| *e < 10.0) {
                return Err(refuse(CLAIM, "the class closes at postures derived again", 10.0, 1.0));
            }
            if change < SAME {
                break;
            }
        }
        let step = (0..n)
            .map(|i| most(STEP, i, &error, &velocity) + self.period * maxima.fed[i])
            .collect();
        Ok([error, velocity, step])
    }
}
