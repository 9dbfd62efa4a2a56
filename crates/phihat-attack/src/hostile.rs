//! Signals at their worst: readings off in step with the loop's own answer to them, commands lost when they change
//! most.

use phihat_design::Gains;
use phihat_session::Dice;
use phihat_sim::{Sample, Simulation};
use phihat_study::Study;

use crate::run::NoRun;

/// Samples over which an answer to a misreading is looked at, and the first of them.
const ANSWER: usize = 400;
const FIRST: usize = 60;

/// Misreading that is small enough for the loop to be linear in it \[rad\].
const SMALL: f64 = 1e-6;

/// Share of the largest change of a command seen so far at which a row of losses begins.
const LARGE: f64 = 0.7;

/// Noise and losses that somebody chooses.
pub(crate) struct Hostile {
    /// Largest noise of each joint's reading \[rad\].
    noise: Vec<f64>,
    /// Signs of the noise over a window, which then starts over: `[sample][joint]`.
    signs: Vec<Vec<f64>>,
    sample: Sample,
    k: usize,
    /// Most commands in a row, and samples between the starts of rows.
    rows: Option<(usize, usize)>,
    /// Samples since the start of the last row, and losses left of it.
    since: usize,
    left: usize,
    /// Largest change of a command so far.
    largest: f64,
    before: Vec<f64>,
    passed: Vec<f64>,
}

impl Hostile {
    /// Takes noise and rows of losses out of a study, to choose them itself.
    pub(crate) fn of(study: &mut Study, gains: &Gains, dice: &mut Dice) -> Result<Self, NoRun> {
        let n = study.robot.joints.len();
        let noise = core::mem::replace(&mut study.sensor.position_noise_max, vec![0.0; n]);
        let period = study.control.period_ns as f64 * 1e-9;
        let rows = study.world.network.rows.take();
        let noisy = noise.iter().any(|most| *most > 0.0);
        let signs = if noisy { signs(study, gains, dice)? } else { Vec::new() };
        Ok(Self {
            noise,
            signs,
            sample: Sample::of(n),
            k: 0,
            rows: rows.map(|rows| (rows.most as usize, samples(rows.apart, period))),
            since: 0,
            left: 0,
            largest: 0.0,
            before: vec![0.0; n],
            passed: vec![0.0; n],
        })
    }

    /// The sample with its noise.
    pub(crate) fn misread(&mut self, sample: &Sample) -> &Sample {
        self.sample.take(sample);
        if let Some(signs) = self.signs.get(self.k % self.signs.len().max(1)) {
            for ((joint, sign), most) in self.sample.joints.iter_mut().zip(signs).zip(&self.noise) {
                joint.q += sign * most;
            }
        }
        self.k += 1;
        &self.sample
    }

    /// The torques that arrive: those of a command, or, where it is lost, those of the one before.
    pub(crate) fn lose(&mut self, torque: &[f64]) -> &[f64] {
        let pairs = torque.iter().zip(&self.before);
        let change = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        self.largest = self.largest.max(change);
        self.before.copy_from_slice(torque);
        self.since += 1;
        if let Some((most, apart)) = self.rows
            && self.since >= apart
            && (change >= LARGE * self.largest || self.since > 2 * apart)
        {
            (self.since, self.left) = (0, most);
        }
        if self.left > 0 {
            self.left -= 1;
        } else {
            self.passed.copy_from_slice(torque);
        }
        &self.passed
    }
}

/// Whole samples in a time, rounded up.
fn samples(time: f64, period: f64) -> usize {
    let whole = std::time::Duration::try_from_secs_f64((time / period - 1e-9).ceil());
    whole.map_or(usize::MAX, |own| usize::try_from(own.as_secs()).unwrap_or(usize::MAX))
}

/// Signs of misreadings: those with which the answer of one joint, or of its torque, is largest at the end of each
/// window; in some runs each sign lasts for a random time.
fn signs(study: &Study, gains: &Gains, dice: &mut Dice) -> Result<Vec<Vec<f64>>, NoRun> {
    let n = study.robot.joints.len();
    let (target, torque) = (dice.below(n), dice.chance(0.3));
    let mut window = vec![vec![1.0; n]; ANSWER];
    if dice.chance(0.2) {
        let often = dice.pick(&[0.5, 0.1, 0.02]);
        let mut now = vec![1.0; n];
        for signs in &mut window {
            for own in &mut now {
                *own = if dice.chance(often) { -*own } else { *own };
            }
            signs.clone_from(&now);
        }
        return Ok(window);
    }
    let quiet = quiet(study);
    let rest = played(&quiet, gains, None, (target, torque))?;
    for j in 0..n {
        let after = played(&quiet, gains, Some(j), (target, torque))?;
        for (age, (own, rest)) in after.iter().zip(&rest).enumerate().take(ANSWER) {
            window[ANSWER - 1 - age][j] = (own - rest).signum();
        }
    }
    Ok(window)
}

/// The study with exact encoders, without friction and for a moment.
fn quiet(study: &Study) -> Study {
    let mut own = study.clone();
    own.sensor.encoder_bits = None;
    own.world.robot_friction = false;
    own.world.extra_coulomb.fill(0.0);
    own.world.stiction = None;
    own.world.drive = None;
    own.sensor.jitter = 0.0;
    own.duration = (FIRST + ANSWER) as f64 * own.control.period_ns as f64 * 1e-9;
    if let Some(supervisor) = &mut own.supervisor {
        supervisor.requests.clear();
    }
    own
}

/// Error of a joint, or change of its torque, over the samples from [`FIRST`] on, at which one reading is off, if any.
fn played(
    study: &Study,
    gains: &Gains,
    misread: Option<usize>,
    (target, torque): (usize, bool),
) -> Result<Vec<f64>, NoRun> {
    let mut own = study.clone();
    phihat_sim::derive_substeps(&mut own);
    gains.complete(&mut own)?;
    let names = own.robot.joint_names();
    let law = gains.joint_gains(&names, own.control.period_ns, own.control.form)?;
    let (mut control, mut world) = Simulation::new(&own, &law)?.apart();
    let (mut list, mut k, mut before) = (Vec::with_capacity(ANSWER), 0, 0.0);
    while let Some(sensed) = world.sense() {
        let mut sample = sensed.sample.clone();
        if let Some(joint) = misread.filter(|_| k == FIRST) {
            sample.joints[joint].q += SMALL;
        }
        control.step(sensed.t_ns as f64 * 1e-9, &sample, sensed.runs);
        let tau: Vec<f64> = control.commands().iter().map(|command| command.tau).collect();
        world.brake(control.report().copied().as_ref());
        world.act(&tau);
        let error = world.acted(target, 1.0).q - control.references()[target].q;
        let change = tau[target] - core::mem::replace(&mut before, tau[target]);
        if k >= FIRST {
            list.push(if torque { change } else { error });
        }
        k += 1;
    }
    Ok(list)
}
