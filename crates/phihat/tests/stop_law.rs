//! A stop sample by sample, of a joint that is where the test says. Wrong if it begins elsewhere or at
//! another speed, if the drive may give more energy than (Q1) says or less, or if a drive is let go, tried or
//! taken back at another sample than the rule says. The rule is written down here once more, with sums over
//! the past in place of recursions.
#![allow(clippy::large_types_passed_by_value, reason = "a test reads better so")]

use crate::arm::{Dice, FIRST};
use crate::joint::{INERTIA, Joint, T, T_NS, gains, outer};
use crate::monitors::spread;
use phihat::{
    Command, Events, JointOptions, Limits, Measurement, Mode, ModeRequest, MotionLimits, Options,
    Reference,
};

const KP: f64 = 400.0;
const KD: f64 = 40.0;
const LOAD: f64 = 5.0;
const STOP: MotionLimits = MotionLimits { velocity: 1.0, acceleration: 2.0, jerk: 40.0 };
/// Least mean square of the torque that a drive is judged by: this, squared, at first motion, and a sixteenth
/// of it in a stop.
const EXCITATION: f64 = 3.0;
const TORQUE_MAX: f64 = 40.0;

/// A joint that has tracked a motion of so many rad/s under a load that it knows, and where it is.
fn moving(speed: f64, limits: Limits<f64>, hold_samples: u32) -> (Joint, Measurement<f64>) {
    let options = JointOptions {
        stop: Some(STOP),
        first_motion: Some(EXCITATION),
        ..JointOptions::default()
    };
    let law = gains(KP, KD, FIRST).with_limits(limits);
    let arm = Options { hold_samples, stop_samples: 50, ..Options::new(T_NS) };
    let mut joint = Joint::new(law, options, &arm);
    let mut m = Measurement { q: 0.1, dq: 0.0, tau_applied: LOAD };
    for _ in 0..300 {
        // The drives are judged while it stands.
        joint.hold(m, Reference { q: m.q, ..Reference::default() });
    }
    for k in 0..3000 {
        // Within a second up to the speed.
        let ddq = if k < 1000 { speed } else { 0.0 };
        m.dq += T * ddq;
        m.q += T * m.dq;
        m.tau_applied = LOAD + INERTIA * ddq;
        joint.step(ModeRequest::Track, m, Reference { q: m.q, dq: m.dq, ddq });
    }
    let phi_hat = joint.state.joints[0].phi_hat();
    assert!((phi_hat - LOAD).abs() < 1e-12, "{speed}: {phi_hat}");
    (joint, m)
}

/// A stop of one joint, computed from the words of its documentation.
struct ByHand {
    /// Torque that held the joint before \[N·m\].
    known: f64,
    /// Energy that the drive may give \[J\].
    reserve: f64,
    /// Position of rest \[rad\], and number of samples near it.
    place: (f64, u32),
    /// Samples in which a torque was held back since the stop began, and number of times that it began anew
    /// for that.
    held_back: u32,
    anew: u32,
    begun: bool,
    /// Speed beyond which a stop drives \[rad/s\], the largest one since, and torques and steps of velocity since.
    fastest: Option<f64>,
    peak: f64,
    past: Vec<(f64, f64)>,
    row: u32,
    /// Samples since the drive lost its torque, and the results of the trial that runs.
    let_go: Option<u32>,
    trial: Vec<(f64, f64)>,
    taken_back: u32,
    last: Measurement<f64>,
    told: f64,
}

/// Expected result of one sample.
#[derive(Debug, PartialEq)]
struct Want {
    tau: f64,
    held_back: bool,
    let_go: bool,
    /// The stop begins here: the reference starts at the joint.
    begins: bool,
}

impl ByHand {
    fn new(known: f64, last: Measurement<f64>) -> Self {
        Self {
            known,
            reserve: 0.0,
            place: (0.0, 0),
            held_back: 0,
            anew: 0,
            begun: false,
            fastest: None,
            peak: 0.0,
            past: Vec::new(),
            row: 0,
            let_go: None,
            trial: Vec::new(),
            taken_back: 0,
            last,
            told: known,
        }
    }

    fn step(&mut self, m: &Measurement<f64>, law: f64, phi_hat: f64) -> Want {
        let moved = m.q - self.last.q;
        let mut want = Want { tau: 0.0, held_back: false, let_go: false, begins: !self.begun };
        if !self.begun {
            (self.begun, self.held_back) = (true, 0);
            self.fastest = self.fastest.or(Some(0.2 + (moved / T).abs()));
        }
        // What held a joint that sinks time and again does not hold it: a mean over half a second does.
        if self.anew >= 4 && m.dq.abs() <= 0.1 {
            self.known += T / 0.5 * (phi_hat - self.known);
        }
        self.count(m, moved);
        want.tau = law;
        let gives = (law - self.known) * moved;
        if gives > 0.0 && gives > self.reserve {
            want.held_back = true;
            want.tau = self.known + (self.reserve.max(0.0) / gives) * (law - self.known);
            self.held_back += 1;
            if self.held_back >= 10 {
                self.begun = false;
                self.anew += 1;
            }
        }
        want.tau = self.probed(m, want.tau, &mut want.let_go);
        self.last = *m;
        self.told = want.tau.clamp(-TORQUE_MAX, TORQUE_MAX);
        Want { tau: self.told, ..want }
    }

    /// The energy of the last sample, and rest: within 0.02 rad/s for 64 samples.
    fn count(&mut self, m: &Measurement<f64>, moved: f64) {
        let most = 0.5 * INERTIA * 0.2 * 0.2;
        self.reserve = (self.reserve - (m.tau_applied - self.known) * moved).min(most);
        if (m.q - self.place.0).abs() > 0.02 * 64.0 * T {
            self.place = (m.q, 0);
        } else if self.place.1 < 64 {
            self.place.1 += 1;
        } else {
            self.place = (m.q, 0);
            self.reserve = most;
        }
        self.reserve = self.reserve.max(-most);
    }

    fn probed(&mut self, m: &Measurement<f64>, demand: f64, let_go: &mut bool) -> f64 {
        if let Some(age) = self.let_go {
            return self.tried(m, age);
        }
        let speed = m.dq.abs();
        let brakes = (m.tau_applied - self.known) * m.dq < 0.0;
        let faster = brakes && self.fastest.is_some_and(|fastest| speed > fastest);
        if !faster || speed < 0.98 * self.peak {
            (self.past, self.row) = (Vec::new(), 0);
            self.peak = if faster { self.peak } else { 0.0 };
            return demand;
        }
        self.peak = self.peak.max(speed);
        self.past.push((m.tau_applied, m.dq - self.last.dq));
        let (both, square) = spread(&self.past);
        let excited = square > EXCITATION * EXCITATION / 16.0;
        self.row = if excited && both < 0.05 * T / INERTIA * square { self.row + 1 } else { 0 };
        if self.row >= 8 && speed >= self.peak {
            (self.let_go, *let_go) = (Some(1), true);
            return 0.0;
        }
        // Sixteen samples with half of what brakes, sixteen with the whole.
        if self.past.len() % 32 < 16 {
            0.5 * (self.known + demand.clamp(-TORQUE_MAX, TORQUE_MAX))
        } else {
            demand
        }
    }

    /// After 64, 128, 256 … samples, for 48 of them: eight with a small torque, eight without. After the first time
    /// that it was taken back from 256 samples on, after the second from 1024.
    fn tried(&mut self, m: &Measurement<f64>, age: u32) -> f64 {
        self.let_go = Some(age + 1);
        let first = 6 + 2 * self.taken_back;
        let begun = (first..32).map(|n| 1_u32 << n).take_while(|begun| *begun <= age).last();
        let Some(since) = begun.map(|begun| age - begun).filter(|since| *since < 48) else {
            return 0.0;
        };
        if since == 0 {
            self.trial.clear();
        }
        self.trial.push((self.told, m.dq - self.last.dq));
        if since % 16 == 15 {
            let (both, square) = spread(&self.trial);
            // Twice what a watched joint needs.
            if both <= 0.1 * T / INERTIA * square {
                // The rest of the trial is left out.
                self.let_go = Some(age - since + 48);
                return 0.0;
            }
        }
        if since == 47 {
            let fastest = Some(m.dq.abs());
            let taken_back = self.taken_back + 1;
            *self = Self { fastest, taken_back, ..Self::new(self.known, self.last) };
            return 0.0;
        }
        match since % 16 {
            0..8 => {
                if m.dq > 0.0 {
                    -EXCITATION
                } else {
                    EXCITATION
                }
            }
            _ => 0.0,
        }
    }
}

/// A joint in a world of its own: how much of the torque acts, and what pushes beside the load.
struct World {
    drive: f64,
    push: f64,
}

/// A stop from a speed in a world that changes by `world(k)`; how often each thing happened.
fn stopped(speed: f64, world: impl Fn(u32) -> World, samples: u32, seed: u64) -> [u32; 5] {
    let limits = Limits::new(Some(TORQUE_MAX), None, T).unwrap();
    // Samples for which a torque is held, and a joint may be faster before the brakes are asked for.
    let hold_samples = if seed.is_multiple_of(2) { 5 } else { 40 };
    let (mut joint, mut m) = moving(speed, limits, hold_samples);
    let mut hand = ByHand::new(LOAD, m);
    let mut dice = Dice(seed);
    let [mut held_back, mut let_go, mut driven, mut taken_back, mut anew] = [0; 5];
    let mut braked = false;
    let (mut q, mut dq) = (m.q + T * m.dq, m.dq);
    for k in 0..samples {
        // Sensors of a drive: a little noise in torque.
        let tau_applied = joint.state.joints[0].tau() + dice.within(-0.1, 0.1);
        m = Measurement { q, dq, tau_applied };
        let answer = joint.step(ModeRequest::Stop, m, Reference::default());
        let Command { tau, phi_hat, .. } = answer.commands[0];
        let told = answer.report.events;
        assert_eq!(answer.report.mode, Mode::SafeStop);
        assert!(!told.contains(Events::TORQUE_REFUSED));
        let at = *joint.state.joints[0].reference();
        let want = hand.step(&m, outer(KP, KD, &m, &at) + phi_hat, phi_hat);
        let context = || format!("{seed}: {k} {m:?} {at:?} {tau} against {want:?}");
        assert!((tau - want.tau).abs() < 1e-8 * (1.0 + want.tau.abs()), "{}", context());
        assert_eq!(told.contains(Events::HELD_BACK), want.held_back, "{}", context());
        assert_eq!(told.contains(Events::LET_GO), want.let_go, "{}", context());
        // At rest, after half a second, or where the drive drives: let go, or faster for more samples than a
        // torque is held for.
        braked |= m.dq.abs() <= 0.05
            || k >= 500
            || hand.let_go.is_some()
            || hand.past.len() > hold_samples as usize;
        assert_eq!(answer.report.brake, braked, "{}", context());
        if want.begins {
            // One step of the profile from where the joint was at the last sample.
            let off = (at.q - m.q).abs();
            assert!(off < 2.0 * STOP.acceleration * T * T, "{}", context());
        }
        held_back += u32::from(want.held_back);
        let_go += u32::from(want.let_go);
        driven += u32::from(hand.let_go.is_some() && want.tau.abs() > 0.0);
        taken_back = hand.taken_back;
        anew = anew.max(hand.anew);
        let World { drive, push } = world(k);
        let ddq = (drive * tau + push - LOAD) / INERTIA;
        q += T * (dq + 0.5 * T * ddq);
        dq += T * ddq;
    }
    [held_back, let_go, driven, taken_back, anew]
}

#[test]
fn f31_the_drive_gives_what_the_stop_took_and_no_more() {
    let (mut held_back, mut anew) = (0, 0);
    for seed in 0..40 {
        let mut dice = Dice(3100 + seed);
        let speed = dice.within(-0.3, 0.3);
        // Pushed to and fro, and a load that is another one from some sample on.
        let (size, every) = (dice.within(0.0, 6.0), dice.within(20.0, 300.0));
        let other = dice.within(-4.0, 4.0);
        let world = |k: u32| {
            let wave = (f64::from(k) / every).sin().signum();
            let more = if k > 600 { other } else { 0.0 };
            World { drive: 1.0, push: if k < 1500 { size * wave + more } else { more } }
        };
        let [held, let_go, .., begun] = stopped(speed, world, 2500, seed);
        assert_eq!(let_go, 0, "a drive that does what it is told is not let go");
        (held_back, anew) = (held_back + held, anew + u32::from(begun > 2));
    }
    println!("held back in {held_back} samples; {anew} of 40 began anew more than twice");
    assert!(held_back > 300 && anew > 0, "{held_back} {anew}");
}

#[test]
fn f31_a_drive_is_let_go_tried_and_taken_back_at_the_sample_that_the_rule_says() {
    let [mut let_go, mut driven, mut back, mut twice, mut back_twice] = [0; 5];
    for seed in 0..60 {
        let mut dice = Dice(3200 + seed);
        let speed = dice.within(-0.8, 0.8);
        let drive =
            [-1.0, 0.0, 0.03, 0.08, 1.0, 0.5][usize::from(dice.bits().to_le_bytes()[0] % 6)];
        let push = dice.within(-30.0, 30.0);
        // What is wrong ends, or does not, or comes again.
        let until = [200, 1000, 5000][usize::from(dice.bits().to_le_bytes()[0] % 3)];
        let again = 1500 + u32::from(dice.bits().to_le_bytes()[0]);
        let world = |k: u32| {
            let wrong = k < until || (again..again + 300).contains(&k);
            World { drive: if wrong { drive } else { 1.0 }, push: if k < 60 { push } else { 0.0 } }
        };
        let [_, gone, tried, taken, _] = stopped(speed, world, 4000, seed);
        let_go += u32::from(gone > 0);
        twice += u32::from(gone > 1);
        driven += u32::from(tried > 0);
        back += u32::from(taken > 0);
        back_twice += u32::from(taken > 1);
    }
    println!(
        "{let_go} of 60 let go, {driven} tried, {back} taken back, {twice} let go again, {back_twice} taken back again"
    );
    assert!(let_go > 20 && driven > 20 && back > 5, "{let_go} {driven} {back}");
    assert!(twice > 2 && back_twice > 0, "{twice} {back_twice}");
}

#[test]
fn a_stop_begins_where_the_joint_is_at_the_speed_that_it_goes() {
    for (speed, periods) in [(0.3, 1_u32), (-0.2, 1), (0.0, 1), (0.3, 2), (-0.4, 3)] {
        let (mut joint, mut m) = moving(speed, Limits::none(), 5);
        // How far it went counts, since the last sample; a velocity may be filtered.
        let gone = 1.2 * speed;
        m.q += f64::from(periods) * T * gone;
        joint.k += u64::from(periods) - 1;
        let phi_hat = joint.state.joints[0].phi_hat();
        let begun = m.q;
        for k in 0..2000 {
            let answer = joint.step(ModeRequest::Stop, m, Reference::default());
            assert_eq!(answer.report.mode, Mode::SafeStop);
            let at = *joint.state.joints[0].reference();
            if k == 0 {
                let off = (at.q - begun).abs();
                assert!(off < 2.0 * STOP.acceleration * T * T, "{speed} {periods}: {at:?}");
                assert!((at.dq - gone).abs() < 2.0 * STOP.acceleration * T, "{at:?}");
                assert!((answer.commands[0].phi_hat - phi_hat).abs() < 1e-9, "φ̂ stays");
            }
            // It goes where it is told to, which takes energy out of it.
            let (q, dq) = (at.q + T * at.dq, at.dq + T * at.ddq);
            m = Measurement { q, dq, tau_applied: LOAD + INERTIA * at.ddq };
        }
        // It brakes over v²/2A and vA/2J from where its motion would have been a sample ago.
        let way = gone * (gone.abs() / (2.0 * 2.0) + 2.0 / (2.0 * 40.0));
        let at = joint.state.joints[0].reference();
        let off = at.q - (begun - T * gone + way);
        assert!(off.abs() < 1e-9 && at.dq.abs() < 1e-9, "{speed} {periods}: {at:?}, off by {off}");
    }
}

/// Speeds at which a stop drives, to the last bit: halved is what brakes a joint that is faster than it may
/// be, for as long as it stays at 98 % of its largest speed.
#[test]
fn a_joint_is_faster_beyond_a_speed_and_while_it_keeps_most_of_it() {
    for (speeds, tau_applied, halved) in [
        (&[0.2][..], LOAD - 1.0, false),
        (&[0.2 + 1e-9], LOAD - 1.0, true),
        (&[-0.2], LOAD + 1.0, false),
        (&[-0.2 - 1e-9], LOAD + 1.0, true),
        // What acts does not brake.
        (&[0.3], LOAD + 1.0, false),
        (&[-0.3], LOAD - 1.0, false),
        (&[1.0, 0.98], LOAD - 1.0, true),
        (&[1.0, 0.979], LOAD - 1.0, false),
        (&[1.0, 0.979, 0.979], LOAD - 1.0, false),
        (&[1.0, 0.979, 1.0], LOAD - 1.0, true),
    ] {
        let (mut joint, mut m) = moving(0.0, Limits::none(), 5);
        joint.step(ModeRequest::Stop, m, Reference::default());
        let mut is = f64::NAN;
        for dq in speeds {
            m = Measurement { q: m.q + T * dq, dq: *dq, tau_applied };
            let Command { tau, phi_hat, .. } =
                joint.step(ModeRequest::Stop, m, Reference::default()).commands[0];
            let law = outer(KP, KD, &m, joint.state.joints[0].reference()) + phi_hat;
            is = (tau - LOAD) / (law - LOAD);
        }
        let want = if halved { 0.5 } else { 1.0 };
        assert!((is - want).abs() < 1e-9, "{speeds:?} {tau_applied}: {is}");
    }
}

/// A joint that a stop let go is held again from the moment at which the arm is armed anew.
#[test]
fn an_arm_that_is_armed_anew_is_held_though_its_stop_let_a_joint_go() {
    let (mut joint, mut m) = moving(0.0, Limits::none(), 5);
    let mut gone = false;
    for _ in 0..300 {
        // It runs away from what it is told.
        let tau = joint.state.joints[0].tau();
        m.dq -= T / INERTIA * (tau - LOAD) - if gone { 0.0 } else { 2e-3 };
        m = Measurement { q: m.q + T * m.dq, tau_applied: tau, ..m };
        let answer = joint.step(ModeRequest::Stop, m, Reference::default());
        gone |= answer.report.events.contains(Events::LET_GO);
    }
    assert!(gone);
    m.dq = 0.0;
    for mode in [ModeRequest::Stop, ModeRequest::Arm] {
        for _ in 0..200 {
            let answer = joint.step(mode, m, Reference::default());
            let Command { tau, phi_hat, .. } = answer.commands[0];
            if mode == ModeRequest::Arm {
                assert_eq!(answer.report.mode, Mode::Armed);
                assert!(
                    (tau - LOAD).abs() < 1.0 && (tau - phi_hat).abs() < 1e-9,
                    "{tau} {phi_hat}"
                );
            }
        }
    }
}
