//! A robot that lies, in every field of its messages, once or for good. Wrong if a torque were sent that is
//! not finite or beyond the limits of the study; if a drive went on without a valid sensor; or if a measured
//! torque that no drive can deliver were accepted.
//!
//! `PHIHAT_MESSAGES=1000000` for as many; `cargo xtask test --all` has them.

use std::sync::atomic::AtomicBool;

use crate::support::{Dice, PLAIN, SUPERVISED, names, sides, study};
use phihat::{Mode, Released};
use phihat_drive::{
    Cycle, Desk, End, Facts, Link, LinkFault, Order, Plan, SimLink, Tally, Wait, cycles, ring,
};
use phihat_sim::Sample;
use phihat_study::Study;

/// Numbers that are none, or too large, or almost right.
const WILD: [f64; 14] = [
    f64::NAN,
    f64::INFINITY,
    f64::NEG_INFINITY,
    f64::MAX,
    -1e308,
    3e9,
    -1e6,
    1e3,
    -60.0,
    20.0,
    6.4,
    -0.1,
    5e-324,
    0.0,
];

/// One lie: which field of which joint, what it says, until which message.
#[derive(Debug, Clone, Copy)]
struct Lie {
    field: usize,
    joint: usize,
    says: f64,
    until: u64,
}

/// Plan of the lies: anything at any time, or one lie from a message on.
enum Plot {
    /// Lies of all kinds.
    Any(Dice),
    /// One lie from a message on.
    From(u64, Lie),
}

/// The simulated arm, whose messages are not what it measured.
struct Liar {
    sim: SimLink,
    facts: Facts,
    plot: Plot,
    lie: Option<Lie>,
    message: u64,
    most: f64,
    step: f64,
    sent: Vec<f64>,
    finished: u32,
}

impl Liar {
    fn new(study: &Study, plot: Plot) -> Self {
        let sim = SimLink::lock_step(study, sides(study).1);
        let mut facts = sim.facts().clone();
        // A robot: what it does at the end is not known.
        facts.tells.truth = false;
        let n = names(study).len();
        let limits: Vec<_> = (0..n).map(|i| study.limits(i)).collect();
        let most = limits.iter().filter_map(|(torque, _)| *torque).fold(0.0, f64::max);
        let rate = limits.iter().filter_map(|(_, rate)| *rate).fold(0.0, f64::max);
        let step = if rate > 0.0 { rate * 1e-3 } else { f64::INFINITY };
        let sent = vec![0.0; n];
        Self { sim, facts, plot, lie: None, message: 0, most, step, sent, finished: 0 }
    }

    fn lies(&mut self, sample: &mut Sample) {
        self.message += 1;
        let n = sample.joints.len();
        match &mut self.plot {
            Plot::From(from, lie) if self.message >= *from => self.lie = Some(*lie),
            Plot::Any(dice) if self.lie.is_none_or(|lie| lie.until < self.message) => {
                self.lie = (dice.below(20) == 0).then(|| Lie {
                    field: dice.below(6),
                    joint: dice.below(n),
                    says: WILD[dice.below(WILD.len())],
                    until: self.message + [0, 0, 0, 3, 40, 2000][dice.below(6)],
                });
            }
            _ => {}
        }
        let Some(lie) = self.lie.filter(|lie| lie.until >= self.message) else { return };
        let joint = &mut sample.joints[lie.joint];
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a lie")]
        match lie.field {
            0 => joint.q = lie.says,
            1 => joint.dq = lie.says,
            2 => joint.tau_applied = lie.says,
            3 => sample.accepted[lie.joint] = lie.says,
            4 => sample.sequence = lie.says as u64,
            _ => sample.t_ns = lie.says as u64,
        }
    }
}

impl Link for Liar {
    fn facts(&self) -> &Facts {
        &self.facts
    }
    fn start(&mut self) -> Result<(), LinkFault> {
        self.sim.start()
    }
    fn wait(&mut self, sample: &mut Sample) -> Wait {
        let wait = self.sim.wait(sample);
        self.lies(sample);
        wait
    }
    fn send(&mut self, tau: Released<'_, f64>) {
        for (tau, last) in tau.tau().iter().zip(&mut self.sent) {
            assert!(tau.is_finite() && tau.abs() <= self.most, "{tau} N·m at {:?}", self.lie);
            assert!(
                (tau - *last).abs() <= self.step + 1e-9,
                "{last} to {tau} N·m at {:?}",
                self.lie
            );
            *last = *tau;
        }
        self.sim.send(tau);
    }
    fn finish(&mut self, _: Released<'_, f64>) -> Result<(), LinkFault> {
        self.finished += 1;
        Ok(())
    }
    fn recover(&mut self) -> Result<(), LinkFault> {
        Err(LinkFault::NoRecovery)
    }
}

fn driven(
    study: &Study,
    link: &mut Liar,
    samples: u64,
    fault_samples: Option<u64>,
) -> (Tally, Vec<Cycle>) {
    let (mut control, _) = sides(study);
    let names = names(study);
    let order = Order::new(&names, None, names.len()).unwrap();
    let mut desk = Desk::new(order, names.len());
    let (mut tape, mut reader) = ring(names.len(), usize::try_from(samples).unwrap(), false);
    let stop = AtomicBool::new(false);
    let plan =
        Plan { samples, stop_samples: 500, stop: &stop, fault_samples, targets: None, park: None };
    let tally = cycles(link, &mut control, &mut tape, &mut desk, &plan);
    drop(tape);
    let (mut read, mut rows) = (Vec::new(), Vec::new());
    while let Some(cycle) = reader.next(&mut rows) {
        read.push(cycle);
    }
    (tally, read)
}

/// Drives without a supervisor; rate limits; and a robot whose rule counts from its reported accepted torque,
/// with and without a supervisor.
#[test]
fn f33_whatever_a_robot_says_no_torque_beyond_a_limit_is_sent() {
    let all = if std::env::var_os("PHIHAT_ALL").is_some() { 1_000_000 } else { 40_000 };
    let all = std::env::var("PHIHAT_MESSAGES").map_or(all, |n| n.parse().unwrap());
    let rate = PLAIN.replace("rate_hz = 1000.0", "rate_hz = 1000.0\ntorque_rate_max_nm_s = 1000.0");
    let echo = format!("{PLAIN}[profile]\nname = \"franka\"\n");
    let (mut messages, mut round, mut stopped) = (0, 0_u64, 0);
    while messages < all {
        let text = [PLAIN, &rate, &echo][usize::try_from(round % 3).unwrap()].to_owned();
        let text = if round % 2 == 0 { format!("{text}{SUPERVISED}") } else { text };
        let study = study(&text);
        let mut link = Liar::new(&study, Plot::Any(Dice(round)));
        let (tally, cycles) = driven(&study, &mut link, 2000, None);
        assert!(tally.cycles > 0, "{tally:?}");
        messages += link.message;
        stopped +=
            u32::from(cycles.iter().any(|c| c.report.is_some_and(|r| r.mode == Mode::SafeStop)));
        round += 1;
    }
    println!("{messages} messages, {round} drives, {stopped} of them stopped");
    assert!(stopped > 0);
}

/// A position that is NaN for good: the arm is stopped, and the drive ends, where something else holds the arm.
#[test]
fn a_drive_ends_where_a_sensor_is_none_any_more() {
    let study = study(&format!("{PLAIN}{SUPERVISED}brake_closing_s = 0.1\n"));
    let lie = Lie { field: 0, joint: 1, says: f64::NAN, until: u64::MAX };
    let mut link = Liar::new(&study, Plot::From(1000, lie));
    let (tally, cycles) = driven(&study, &mut link, 2000, Some(500));
    assert_eq!((tally.end, link.finished), (End::Faulted, 1));
    assert!((1000..1600).contains(&tally.cycles), "{tally:?}");
    let last = cycles.last().unwrap().report.unwrap();
    assert!(last.brake && last.mode == Mode::SafeStop, "{last:?}");
}

/// One measured torque of a million N·m: the last command counts instead, and the arm goes on.
#[test]
fn one_measured_torque_that_is_none_changes_nothing() {
    let text = format!("{PLAIN}{SUPERVISED}");
    let study = study(&text);
    let lie = Lie { field: 2, joint: 1, says: 1e6, until: 1000 };
    let mut link = Liar::new(&study, Plot::From(1000, lie));
    let (tally, cycles) = driven(&study, &mut link, 2000, None);
    assert_eq!(tally.end, End::Complete);
    let tracks = |cycle: &Cycle| cycle.report.is_some_and(|report| report.mode == Mode::Tracking);
    assert!(cycles[10..].iter().all(tracks), "it goes on");
}
