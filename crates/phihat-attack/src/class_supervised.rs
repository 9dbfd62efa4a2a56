//! Runs that try to leave the bound for a class of motions by what they request of the supervisor, by readings that are
//! off and by commands that they lose.

use phihat::Mode;
use phihat_certificate::ClassBound;
use phihat_design::Gains;
use phihat_session::Dice;
use phihat_sim::{ControlSide, Simulation};
use phihat_study::{MotionClass, ReferenceRequest, RequestedMode, Study};

use crate::class::{ClassRuns, varied};
use crate::hostile::Hostile;
use crate::run::NoRun;

/// Share of its largest speed at which a joint is fast.
const FAST: f64 = 0.95;

/// Time after a request to stop at which the arm is armed anew \[s\].
const RESTED_S: f64 = 1.2;

/// Way of choosing targets.
#[derive(Debug, Clone, Copy)]
enum Way {
    /// The study's own motion, drawn anew.
    Drawn,
    /// Every joint to the other end of the box once it is fast.
    WhenFast,
    /// All joints to ends of the box at the same random instants, after times about so long \[s\].
    Together(f64),
    /// Each joint to an end of the box or beyond it, at instants of its own.
    Apart(f64),
}

/// Runs one stream of requests and targets that nobody would send, drawn with payload and friction by a seed, and holds
/// what the supervisor makes of it against the bound while it holds or tracks. Noise of readings and rows of lost
/// commands are the worst that is known. Without a supervisor the motion is the study's own, drawn anew.
///
/// # Errors
///
/// [`NoRun`]: the gains are none of this study, or it cannot be simulated.
pub fn hostile_run(
    study: &Study,
    gains: &Gains,
    bound: &ClassBound,
    seed: u64,
) -> Result<ClassRuns, NoRun> {
    let mut dice = Dice::new(seed, 46);
    let mut own = varied(study, seed, &mut dice);
    let period = own.control.period_ns as f64 * 1e-9;
    if let Some(supervisor) = &mut own.supervisor {
        supervisor.requests = requests(&mut dice, own.duration, period);
    }
    let mut hostile = Hostile::of(&mut own, gains, &mut dice)?;
    phihat_sim::derive_substeps(&mut own);
    gains.complete(&mut own)?;
    let names = own.robot.joint_names();
    let law = gains.joint_gains(&names, own.control.period_ns, own.control.form)?;
    let (mut control, mut world) = Simulation::new(&own, &law)?.apart();
    let mut targets = Targets::of(&own, &mut dice);
    let n = names.len();
    let zero = || vec![0.0_f64; n];
    let mut found = ClassRuns {
        runs: 1,
        errors: zero(),
        velocities: zero(),
        steps: zero(),
        torques: zero(),
        ..ClassRuns::default()
    };
    let mut tau = zero();
    // A law alone goes on from the torque that held the arm.
    let mut before: Vec<f64> = control.commands().iter().map(|command| command.tau).collect();
    let mut stopped = false;
    while let Some(sensed) = world.sense() {
        targets.next(&mut control, period, &mut dice);
        control.step(sensed.t_ns as f64 * 1e-9, hostile.misread(sensed.sample), sensed.runs);
        tau.iter_mut().zip(control.commands()).for_each(|(tau, command)| *tau = command.tau);
        let report = control.report().copied();
        world.brake(report.as_ref());
        world.act(hostile.lose(&tau));
        let acts =
            report.is_none_or(|report| matches!(report.mode, Mode::Holding | Mode::Tracking));
        stopped |= report.is_some_and(|report| report.fault.is_some());
        for (i, reference) in control.references().iter().enumerate().filter(|_| acts) {
            let at = world.acted(i, 1.0);
            let more = |list: &mut [f64], size: f64| list[i] = f64::max(list[i], size);
            more(&mut found.errors, (at.q - reference.q).abs() / bound.error_bound_rad[i]);
            more(
                &mut found.velocities,
                (at.dq - reference.dq).abs() / bound.velocity_error_bound_rad_s[i],
            );
            more(&mut found.steps, (tau[i] - before[i]).abs() / bound.torque_step_nm[i]);
            more(&mut found.torques, tau[i].abs() / bound.torque_nm[i]);
        }
        before.copy_from_slice(&tau);
    }
    let lost = world.abort().is_some() || world.end().divergence.is_some();
    Ok(found.judged(lost || stopped, seed))
}

/// Arm, hold, track; then hold and track in turn, and in some runs a stop and all of it again.
fn requests(dice: &mut Dice, duration: f64, period: f64) -> Vec<(f64, RequestedMode)> {
    use RequestedMode::{Arm, Hold, Stop, Track};
    let begins = |t: f64| [(t, Arm), (t + 2.0 * period, Hold), (t + 3.0 * period, Track)];
    let mut list = begins(0.0).to_vec();
    let (often, stops) = (dice.pick(&[0.0, 0.03, 0.3, 2.0]), dice.chance(0.3));
    let stop = dice.between(0.3, 0.5) * duration;
    let mut t = 0.1;
    let mut holds = false;
    while often > 0.0 && t < duration - period {
        t += often * dice.between(0.1, 1.9);
        let free = !stops || t < stop || t > stop + RESTED_S + 0.1;
        if free && t < duration - period {
            holds = !holds;
            list.push((t, if holds { Hold } else { Track }));
        }
    }
    if stops && stop + RESTED_S + 0.1 < duration {
        list.push((stop, Stop));
        list.extend(begins(stop + RESTED_S));
    }
    list.sort_by(|a, b| a.0.total_cmp(&b.0));
    list
}

/// Targets over time.
struct Targets {
    way: Way,
    low: Vec<f64>,
    high: Vec<f64>,
    speed: Vec<f64>,
    at: Vec<f64>,
    /// Time left until each is changed \[s\].
    left: Vec<f64>,
}

impl Targets {
    fn of(study: &Study, dice: &mut Dice) -> Self {
        let (at, low, high, speed, turn) = match &study.reference {
            ReferenceRequest::Any {
                class: MotionClass { center, low, high, speed, acceleration, .. },
                ..
            } => {
                let turn = speed.iter().zip(acceleration).map(|(v, a)| v / a).fold(0.0, f64::max);
                (center.clone(), low.clone(), high.clone(), speed.clone(), turn)
            }
            _ => (Vec::new(), Vec::new(), Vec::new(), Vec::new(), 1.0),
        };
        let mean = turn * dice.pick(&[0.02, 0.2, 1.0, 3.0]);
        let way = match dice.below(5) {
            _ if study.supervisor.is_none() => Way::Drawn,
            0 => Way::Drawn,
            1 => Way::Together(mean),
            2 => Way::Apart(mean),
            _ => Way::WhenFast,
        };
        let left = vec![0.0; at.len()];
        Self { way, low, high, speed, at, left }
    }

    /// An end of the box, or far beyond it.
    fn end(&self, i: usize, up: bool, dice: &mut Dice) -> f64 {
        let beyond = if dice.chance(0.3) { 5.0 } else { 0.0 };
        if up { self.high[i] + beyond } else { self.low[i] - beyond }
    }

    fn next(&mut self, control: &mut ControlSide, period: f64, dice: &mut Dice) {
        let n = self.at.len();
        let moving: Vec<f64> = control.references().iter().map(|reference| reference.dq).collect();
        let mut changed = false;
        let together = dice.chance(0.5);
        for i in 0..n {
            self.left[i] -= period;
            let (due, up) = match self.way {
                Way::Drawn => return,
                Way::WhenFast if moving[i].abs() >= FAST * self.speed[i] => (true, moving[i] < 0.0),
                Way::WhenFast => {
                    (self.left[i] < -20.0 * period && moving[i] == 0.0, dice.chance(0.5))
                }
                Way::Together(_) => (self.left[0] <= 0.0, together),
                Way::Apart(_) => (self.left[i] <= 0.0, dice.chance(0.5)),
            };
            if due {
                self.at[i] = self.end(i, up, dice);
                changed = true;
                let mean = match self.way {
                    Way::Together(mean) | Way::Apart(mean) => mean,
                    _ => 0.0,
                };
                if i > 0 || !matches!(self.way, Way::Together(_)) {
                    self.left[i] = mean * dice.between(0.1, 1.9);
                }
            }
        }
        if let (Way::Together(mean), true) = (self.way, changed) {
            self.left[0] = mean * dice.between(0.1, 1.9);
        }
        if changed {
            control.refer_to(&self.at);
        }
    }
}
