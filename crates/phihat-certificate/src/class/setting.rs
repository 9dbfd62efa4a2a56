//! Scope of a second derivation: class, forces, readings, payloads and start, read from a study.

use phihat_model::{Body, Model, Rotor};
use phihat_study::{Held, Known, MotionClass, Study};

use super::document::{ClassBound, ClassSignals};
use super::maxima::{ClassTorques, Maxima};
use super::signals::{imperfect, lost_rows, without_imperfections};
use super::sums::LostSpacing;
use crate::check::agree::agrees;
use crate::check::plausible::at_most;
use crate::extremes::larger;
use crate::loaded::loaded;
use crate::refutation::refuse;
use crate::{Gains, LoopModel, Refutation, TorqueNoise};

pub(super) const CLAIM: &str = "class of motions";

/// Two ways to compute the same number.
pub(super) const SAME: f64 = 1e-9;

/// Samples for which a supervisor's start may be out of balance before the law acts, at least.
const BEFORE: f64 = 4.0;

/// All that does not depend on a posture.
pub(super) struct ClassSetting<'a> {
    pub(super) n: usize,
    pub(super) period: f64,
    pub(super) class: &'a MotionClass,
    pub(super) nominal: Vec<f64>,
    pub(super) dry: Vec<f64>,
    pub(super) slope: Vec<f64>,
    pub(super) reading: Vec<f64>,
    pub(super) fed: Option<(Model, bool)>,
    /// The arm whose torque of gravity the robot adds by itself.
    pub(super) added: Option<Model>,
    /// Largest age of what is fed forward \[samples\].
    pub(super) late: f64,
    pub(super) start: ClassStart,
    /// Stiction, jitter, lost commands.
    pub(super) signals: ClassSignals,
    pub(super) rows: Option<LostSpacing>,
}

/// Start of the law, as a study has it.
pub(super) struct ClassStart {
    /// True if a supervisor starts it.
    pub(super) supervised: bool,
    /// Torque that it starts with \[N·m\].
    pub(super) preset: Vec<f64>,
    /// Torque by which it is stated to be out of balance \[N·m\].
    pub(super) stated: Option<Vec<f64>>,
}

impl ClassStart {
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

    /// Torque by which the start may be out of balance \[N·m\], for the derivation: as stated; else no less than the
    /// file's, and than what is found here with its margin.
    ///
    /// # Errors
    ///
    /// [`Refutation`]: the file's is less than what is found here.
    pub(super) fn imbalance(
        &self,
        (maxima, claimed): (&Maxima, &ClassBound),
        (study, margin): (&Study, f64),
    ) -> Result<Vec<f64>, Refutation> {
        if !self.supervised || self.stated.is_some() {
            return Ok(claimed.start_nm.clone());
        }
        let found = maxima.start.iter().zip(&study.design.coulomb.1);
        let each = found.zip(&claimed.start_nm).map(|((left, dry), claimed)| {
            let least = larger(*left, *dry);
            at_most(CLAIM, "start out of balance ≤ claimed", least, *claimed)?;
            Ok(larger(*claimed, margin * left))
        });
        each.collect()
    }
}

/// The payloads at the ends of the set, and the study's own.
pub(super) fn bodies(study: &Study) -> Vec<(String, Body)> {
    let set = &study.design.payload;
    let mut all = vec![(set.frame.clone(), set.lightest())];
    all.extend(set.heaviest().into_iter().map(|body| (set.frame.clone(), body)));
    all.extend(study.world.payload.as_ref().map(|own| (own.frame.clone(), own.body())));
    all
}

/// The arm with every payload of [`bodies`], and with the heaviest of them as point masses, its rotors at both ends of
/// their intervals.
///
/// # Errors
///
/// [`Refutation`]: a payload cannot be attached.
pub(super) fn models(study: &Study) -> Result<Vec<Model>, Refutation> {
    let mut all = bodies(study);
    let turns = |body: &Body| body.inertia.iter().any(|entry| entry.abs() > 0.0);
    let points: Vec<(String, Body)> = all
        .iter()
        .filter(|(_, body)| turns(body))
        .map(|(frame, body)| (frame.clone(), Body { inertia: [0.0; 6], ..*body }))
        .collect();
    all.extend(points);
    let rotors = rotors(study).iter();
    let pairs = rotors.flat_map(|rotor| all.iter().map(move |(frame, body)| (rotor, frame, body)));
    let gravity = study.world.gravity;
    pairs
        .map(|(rotor, frame, body)| Ok(loaded(study, (*rotor, body), frame)?.with_gravity(gravity)))
        .collect()
}

pub(super) fn rotors(study: &Study) -> &'static [Rotor] {
    if study.robot.has_rotor_interval() { &[Rotor::Least, Rotor::Most] } else { &[Rotor::Stated] }
}

/// Level of forces of any course \[N·m\] per joint: dry friction or its breakaway level, pushes.
fn forces(study: &Study, signals: &ClassSignals) -> Vec<f64> {
    let level = study.design.coulomb.1.iter().zip(&signals.stiction_nm);
    let mut dry: Vec<f64> = level.map(|(dry, sticks)| larger(*dry, *sticks)).collect();
    for push in &study.world.pushes {
        dry[push.joint] += push.torque.abs();
    }
    dry
}

/// Largest error of a joint's reading \[rad\]: half a quantum, bias, noise.
fn reading(study: &Study, i: usize) -> f64 {
    let sensor = &study.sensor;
    let quantum = sensor.encoder_bits.as_ref().map_or(0.0, |bits| TorqueNoise::quantum(bits[i]));
    0.5 * quantum + sensor.position_bias[i].abs() + sensor.position_noise_max[i]
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
    pub(super) fn of(
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
        let alone = without_imperfections(study);
        crate::tube::counted(&alone).map_err(|why| refuse(CLAIM, &why.to_string(), 1.0, 0.0))?;
        let start = ClassStart::of(study)?;
        let profile = &study.interface.profile;
        let lone =
            profile.adds_friction <= 0.0 && !(profile.adds_gravity && study.feedforward.is_some());
        Refutation::unless(CLAIM, "nothing but gravity is added by the robot", 1.0, 0.0, lone)?;
        let delay = models.iter().map(|m| m.delay_samples).max().unwrap_or(0);
        let signals = imperfect(study)?;
        let mut dry = forces(study, &signals);
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
        Ok(Self {
            n,
            period: study.control.period_ns as f64 * 1e-9,
            class,
            nominal: gains.joints.iter().map(|joint| joint.inertia_kg_m2).collect(),
            slope: (0..n).map(slope).collect(),
            reading: (0..n).map(|i| reading(study, i)).collect(),
            dry,
            fed,
            added: profile
                .adds_gravity
                .then(|| study.robot.plant_model().with_gravity(study.world.gravity)),
            late: if start.supervised { f64::from(delay) + 1.0 } else { 0.5 },
            start,
            rows: lost_rows(study)?,
            signals,
        })
    }

    /// The file is about this study's class, forces, readings and payloads.
    pub(super) fn is_of(&self, claimed: &ClassBound, study: &Study) -> Result<(), Refutation> {
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
        let own = claimed.signals.clone().filter(|own| !own.is_perfect());
        let right = Some(&self.signals).filter(|own| !own.is_perfect());
        Refutation::unless(CLAIM, "signals of the study", 1.0, 0.0, own.as_ref() == right)?;
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

    /// Torques of the arm along motions of the class.
    pub(super) fn torques(&self) -> ClassTorques<'_> {
        ClassTorques {
            class: self.class,
            nominal: &self.nominal,
            fed: self.fed.as_ref().map(|(model, gravity)| (model, *gravity)),
            added: self.added.as_ref(),
            preset: &self.start.preset,
        }
    }
}
