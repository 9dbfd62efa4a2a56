//! Start gains in the printed form. Wrong if a change of order or of `a_0` gave another torque than the
//! integrals, summed here by hand, give from (9) and (10), if it stepped the torque, or if one joint changed
//! without the other.

use crate::joint::{INERTIA, Joint, T, T_NS, outer};
use phihat::{
    Events, Form, JointDesign, JointGains, JointOptions, Measurement, ModeRequest, OptionError,
    Options, Reference, Request, Sample, Schedule, Stamp, Supervisor, SupervisorState,
};

const KP: f64 = 400.0;
const KD: f64 = 40.0;

fn literal(a: &[f64]) -> JointGains<f64> {
    let form = Form::Literal;
    JointGains::new(&JointDesign { inertia: INERTIA, kp: KP, kd: KD, a, period: T, form }).unwrap()
}

/// (9) and (10) with `M̄`, and the integrals by hand.
struct ByHand {
    a: Vec<f64>,
    one: f64,
    two: f64,
}

impl ByHand {
    /// Without the highest integral's part.
    fn rest(&self, e: f64, de: f64) -> f64 {
        match self.a[..] {
            [a0] => -a0 * (de + KD * e),
            [a0, a1] => -a1 * (de + KD * e + KP * self.one) - a0 * (e + KD * self.one),
            _ => f64::NAN,
        }
    }

    fn phi_hat(&self, e: f64, de: f64) -> f64 {
        let highest = if self.a.len() == 1 { self.one } else { self.two };
        INERTIA * (self.rest(e, de) - self.a[0] * KP * highest)
    }

    /// Other gains, which give the same `φ̂` at this sample by their highest integral alone.
    fn change(&mut self, a: &[f64], phi_hat: f64, (e, de): (f64, f64)) {
        *self = Self { a: a.to_vec(), one: 0.0, two: 0.0 };
        let highest = (self.rest(e, de) - phi_hat / INERTIA) / (self.a[0] * KP);
        if a.len() == 1 {
            self.one = highest;
        } else {
            self.two = highest;
        }
    }
}

/// Runs start and running gains up and down again, each sample against the sums by hand; how often they changed.
fn up_and_down(start: &JointGains<f64>, first: &[f64], second: &[f64]) -> Vec<Events> {
    let schedule = Schedule { settled: 1.0, disturbed: 3.0, dwell_s: 0.1 };
    let options = Options { schedule, ..Options::new(T_NS) };
    let joint = JointOptions { start: Some(*start), ..JointOptions::default() };
    let mut joint = Joint::new(literal(second), joint, &options);
    let at = |k: u32| {
        let t = f64::from(k) * T;
        (0.012 + 0.001 * (5.0 * t).sin(), 0.005 * (5.0 * t).cos())
    };
    let (q, dq) = at(0);
    joint.hold(Measurement { q, dq, tau_applied: 0.0 }, Reference::default());
    let mut hand: Option<ByHand> = None;
    let (mut found, mut last, mut before) = (Vec::new(), dq, None::<f64>);
    let (mut changed, mut own, mut at_change) = (false, 0.0, 0.0);
    for k in 1..4000_u32 {
        let (q, dq) = at(k);
        let off = if (1500..2500).contains(&k) { 4.0 } else { 0.3 };
        let moved = INERTIA * (dq - last) / T;
        last = dq;
        let m = Measurement { q, dq, tau_applied: joint.state.joints[0].phi_hat() + off + moved };
        let r = Reference { q: 0.01, dq: 0.001, ddq: 0.1 };
        let answer = joint.step(ModeRequest::Track, m, r);
        let (command, in_force) = (answer.commands[0], *joint.state.joints[0].reference());
        let (e, de) = (q - in_force.q, dq - in_force.dq);
        if let Some(hand) = &mut hand {
            hand.one += T * e;
            hand.two += T * hand.one;
            let want = hand.phi_hat(e, de);
            assert!((command.phi_hat - want).abs() < 1e-9 * (1.0 + want.abs()), "{k}: {command:?}");
        } else {
            let mut new = ByHand { a: first.to_vec(), one: 0.0, two: 0.0 };
            new.change(first, command.phi_hat, (e, de));
            hand = Some(new);
        }
        let tau = outer(KP, KD, &m, &in_force) + command.phi_hat;
        assert!((command.tau - tau).abs() < 1e-9, "{k}: nothing is faded");
        let step = before.map_or(0.0, |before| (tau - before).abs());
        if changed {
            at_change = f64::max(at_change, step);
        } else {
            own = f64::max(own, step);
        }
        changed = false;
        before = Some(tau);
        for (event, a) in [(Events::RAISED, second), (Events::LOWERED, first)] {
            if answer.report.events.contains(event) {
                found.push(event);
                changed = true;
                hand.as_mut().unwrap().change(a, command.phi_hat, (e, de));
            }
        }
    }
    // The law in force moves the torque more from sample to sample than the change does.
    assert!(at_change > 0.0 && at_change <= own, "{at_change} {own}");
    found
}

#[test]
fn the_order_rises_and_falls_as_by_hand() {
    let (first, second) = (&[69.6][..], &[4844.16, 139.2][..]);
    let found = up_and_down(&literal(second).first_order(), first, second);
    assert_eq!(found, [Events::RAISED, Events::LOWERED, Events::RAISED]);
}

#[test]
fn a_reduced_gain_at_the_start_is_as_by_hand() {
    let (first, second) = (&[0.25 * 69.6][..], &[69.6][..]);
    let found = up_and_down(&literal(second).slower(0.25).unwrap(), first, second);
    assert_eq!(found, [Events::RAISED, Events::LOWERED, Events::RAISED]);
}

/// Gains so small that no finite integral gives the held torque: no joint changes, the sound one included.
#[test]
fn all_joints_change_or_none() {
    let options = Options { start_mismatch_max: 10.0, ..Options::new(T_NS) };
    let start = JointOptions { start: Some(literal(&[20.0])), ..JointOptions::default() };
    let run = |weak: &[f64]| {
        let gains = [literal(&[69.6]), literal(weak)];
        let arm = Supervisor::new(gains, &[start; 2], &options).unwrap();
        let mut state = SupervisorState::new();
        let mut raised = 0;
        for k in 0..600_u64 {
            let t_ns = k * T_NS;
            let at = |i: usize| {
                let tau_applied = state.joints[i].phi_hat() + 0.1;
                Measurement { q: 0.1, dq: 0.0, tau_applied }
            };
            let joints = [at(0), at(1)];
            let stamp = Stamp { sequence: k, t_ns };
            let sample = Sample { stamp, now_ns: t_ns, joints: &joints };
            let mode = match k {
                0 => ModeRequest::Arm,
                1 => ModeRequest::Hold,
                _ => ModeRequest::Track,
            };
            let references = [Reference { q: 0.09, dq: 0.0, ddq: 0.0 }; 2];
            let request =
                Request { mode, references: &references, preset: None, feed_forward: None };
            let answer = arm.step(&mut state, &sample, &request);
            assert!(answer.commands.iter().all(|c| c.tau.is_finite()));
            raised += u32::from(answer.report.events.contains(Events::RAISED));
        }
        raised
    };
    assert_eq!(run(&[69.6]), 1);
    assert_eq!(run(&[1e-320]), 0);
}

#[test]
fn start_gains_of_the_other_form_are_refused() {
    let form = Form::Observer;
    let design = JointDesign { inertia: INERTIA, kp: KP, kd: KD, a: &[69.6], period: T, form };
    let start = Some(JointGains::new(&design).unwrap());
    let joint = JointOptions { start, ..JointOptions::default() };
    let refused = Supervisor::new([literal(&[69.6])], &[joint], &Options::new(T_NS));
    assert_eq!(refused.unwrap_err(), OptionError::Form { joint: 0 });
}
