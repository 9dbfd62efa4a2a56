//! The arm at frozen postures, played with the law itself: stability, and the coupled gains.
//!
//! The plant is `M ë = τ − d` with constant `M`, torques held over a sample: its motion is exact. What is played is the
//! controller's own code, so nothing here is shared with those who find or check a certificate.

use phihat::{Command, JointGains, JointState, Measurement, Reference, update_joints};
use phihat_design::{Certificate, Gains};
use phihat_session::Dice;
use phihat_study::Study;

use crate::held::Violation;
use crate::spectrum::{inverse, with_spectrum};

/// Samples of a run, and how often one that has not shrunk is made eight times as long.
const SAMPLES: usize = 1500;
const LONGER: u32 = 2;

/// Inertias drawn inside of the range that is claimed.
const DRAWN: usize = 6;

/// Below this share of its peak a response is rounding.
const FLOOR: f64 = 1e-9;

/// Observed outputs: e, ė, and the change of the commanded torque.
const OUTPUTS: [&str; 3] = ["e", "de", "torque step"];

/// Outputs of one sample, per joint.
type JointOutputs = [Vec<f64>; 3];

/// A frozen arm and its laws.
struct FrozenAttack<'a> {
    laws: &'a [JointGains<f64>],
    inverse: Vec<Vec<f64>>,
    period: f64,
    delay: usize,
}

impl FrozenAttack<'_> {
    /// Simulates torques `d` \[N·m\] and reading errors `n` \[rad\] from rest, one of each per joint and
    /// sample; returns the outputs at each sample. The loop runs for a sample before the first of them.
    fn play(
        &self,
        samples: usize,
        input: &dyn Fn(usize) -> (Vec<f64>, Vec<f64>),
    ) -> Vec<JointOutputs> {
        let n = self.laws.len();
        let mut states = vec![JointState::new(); n];
        let mut commands = vec![Command::default(); n];
        let references = vec![Reference::default(); n];
        let (mut q, mut dq) = (vec![0.0; n], vec![0.0; n]);
        // The torque that acts from sample k on is the front; the newest command is the back.
        let mut on_their_way: std::collections::VecDeque<Vec<f64>> =
            (0..self.delay).map(|_| vec![0.0; n]).collect();
        let (mut acted, mut last) = (vec![0.0; n], vec![0.0; n]);
        let mut all = Vec::with_capacity(samples);
        for k in 0..=samples {
            let (pushed, misread) =
                if k == 0 { (vec![0.0; n], vec![0.0; n]) } else { input(k - 1) };
            let read =
                |i: usize| Measurement { q: q[i] + misread[i], dq: 0.0, tau_applied: acted[i] };
            let read: Vec<_> = (0..n).map(read).collect();
            update_joints(self.laws, &mut states, &read, &references, &mut commands);
            let told: Vec<f64> = commands.iter().map(|command| command.tau).collect();
            let step = told.iter().zip(&last).map(|(a, b)| a - b).collect();
            all.push([q.clone(), dq.clone(), step]);
            last.clone_from(&told);
            on_their_way.push_back(told);
            acted = on_their_way.pop_front().unwrap_or_default();
            for i in 0..n {
                let push = |j: usize| self.inverse[i][j] * (acted[j] - pushed[j]);
                let ddq: f64 = (0..n).map(push).sum();
                q[i] += self.period * (dq[i] + 0.5 * self.period * ddq);
                dq[i] += self.period * ddq;
            }
        }
        all
    }

    /// Returns true if the response to a kick of one sample on every joint shrinks.
    fn shrinks(&self, kick: &[f64]) -> bool {
        let mut samples = SAMPLES;
        let still = vec![0.0; kick.len()];
        for _ in 0..=LONGER {
            let input =
                |k: usize| (if k == 0 { kick.to_vec() } else { still.clone() }, still.clone());
            let seen = self.play(samples, &input);
            let most = |part: &[JointOutputs]| {
                let all = part.iter().flat_map(|seen| &seen[0]);
                all.fold(0.0_f64, |a, x| if x.is_finite() { a.max(x.abs()) } else { f64::INFINITY })
            };
            let (third, fourth) =
                (most(&seen[samples / 2..3 * samples / 4]), most(&seen[3 * samples / 4..]));
            if fourth < third || fourth <= FLOOR * most(&seen) {
                return true;
            }
            samples *= 8;
        }
        false
    }
}

impl FrozenAttack<'_> {
    /// Largest response to a kick of one sample on every joint, times `e^{rate t}`, in the last third of the time
    /// in which more than rounding is left, over that before: at most 1 where every mode decays at least at that rate
    /// \[1/s\].
    fn growth(&self, kick: &[f64], rate: f64) -> f64 {
        let step = rate * self.period;
        let mut samples = SAMPLES;
        while step * (samples as f64) < FADED && samples < LONGEST {
            samples += SAMPLES;
        }
        let still = vec![0.0; kick.len()];
        let input = |k: usize| (if k == 0 { kick.to_vec() } else { still.clone() }, still.clone());
        let weighted = |(k, seen): (usize, &JointOutputs)| {
            seen[0].iter().fold(0.0_f64, |most, x| most.max(x.abs())) * (step * k as f64).exp()
        };
        let all: Vec<f64> = self.play(samples, &input).iter().enumerate().map(weighted).collect();
        let (early, late) = all.split_at(2 * all.len() / 3);
        let most = |part: &[f64]| part.iter().copied().fold(0.0, f64::max);
        most(late) / most(early)
    }
}

/// Decay, as a power of e, below which rounding is seen; samples of the longest run that shows it.
const FADED: f64 = 16.0;
const LONGEST: usize = 40 * SAMPLES;

/// Results at frozen postures.
#[derive(Debug, Default)]
pub(crate) struct AtRest {
    /// Claims that were broken.
    pub(crate) violations: Vec<Violation>,
    /// Reached over claimed coupled gains: the most.
    pub(crate) reached: f64,
}

/// Attacks what is claimed of frozen postures. Loops with drives and laws that hear a velocity are left out.
pub(crate) fn at_rest(study: &Study, gains: &Gains, dice: &mut Dice) -> AtRest {
    let mut found = AtRest::default();
    let Some(certificate) = &gains.certificate else { return found };
    let names: Vec<String> = gains.joints.iter().map(|joint| joint.name.clone()).collect();
    let laws = gains.joint_gains(&names, study.control.period_ns, study.control.form);
    let heard = gains.joints.iter().any(|joint| joint.observer.is_none());
    let (Ok(laws), false, true) = (laws, heard, study.world.drive_bandwidth_hz.is_none()) else {
        return found;
    };
    let own = |inverse| FrozenAttack {
        laws: &laws,
        inverse,
        period: study.control.period_ns as f64 * 1e-9,
        delay: study.control.delay_samples as usize,
    };
    stable(certificate, &own, dice, &mut found);
    for (at, witness) in certificate.coupled.iter().flat_map(|c| c.witnesses.iter().enumerate()) {
        if let Some(inverse) = inverse(&witness.mass_matrix_kg_m2) {
            coupled((certificate, at), &own(inverse), dice, &mut found);
        }
    }
    found
}

/// Any inertia with its spectrum in the claimed range, not only those that the arm has.
fn stable<'a>(
    certificate: &Certificate,
    own: &dyn Fn(Vec<Vec<f64>>) -> FrozenAttack<'a>,
    dice: &mut Dice,
    found: &mut AtRest,
) {
    let arm = &certificate.arm;
    let margin = if certificate.frozen.is_some() { certificate.window_margin } else { 1.0 };
    let range = (arm.low / margin, arm.high * margin);
    for k in 0..DRAWN {
        let ends = k % 2 == 0;
        let matrix = with_spectrum(&arm.nominal_kg_m2, range, ends, dice);
        let Some(inverse) = inverse(&matrix) else { continue };
        let kick: Vec<f64> =
            arm.nominal_kg_m2.iter().map(|m| m * dice.between(-1.0, 1.0)).collect();
        let frozen = own(inverse);
        let rate = certificate.frozen.as_ref().and_then(|frozen| frozen.decay_per_s);
        let growth = rate.map_or(0.0, |rate| frozen.growth(&kick, rate));
        if growth.is_nan() || growth > 1.0 {
            found.violations.push(Violation {
                run: format!("frozen inertia {matrix:?}"),
                joint: String::new(),
                signal: "a kick dies away at a lower rate than is claimed".to_owned(),
                t_s: 0.0,
                measured: growth,
                claimed: (0.0, 1.0),
                ratio: growth,
            });
        }
        if !frozen.shrinks(&kick) {
            found.violations.push(Violation {
                run: format!("frozen inertia {matrix:?}"),
                joint: String::new(),
                signal: "a kick does not die away".to_owned(),
                t_s: 0.0,
                measured: 1.0,
                claimed: range,
                ratio: f64::MAX,
            });
        }
    }
}

/// Attacks one row of the coupled gains at a stored posture: by pushes, then by reading errors, with the
/// signs of the time-reversed response.
fn coupled(
    (certificate, at): (&Certificate, usize),
    frozen: &FrozenAttack<'_>,
    dice: &mut Dice,
    found: &mut AtRest,
) {
    let Some(claimed) = &certificate.coupled else { return };
    let n = frozen.laws.len();
    let still = || vec![0.0; n];
    let [by_torque, by_encoder] = [
        [&claimed.error_rad_per_nm, &claimed.velocity_rad_s_per_nm, &claimed.torque_step_nm_per_nm],
        [
            &claimed.encoder_error_rad_per_rad,
            &claimed.encoder_velocity_per_s,
            &claimed.encoder_torque_step_nm_per_rad,
        ],
    ];
    for (encoder, bounds) in [(false, by_torque), (true, by_encoder)] {
        let given = |values: Vec<f64>| if encoder { (still(), values) } else { (values, still()) };
        // Responses to one sample of one input.
        let kicks: Vec<Vec<JointOutputs>> = (0..n)
            .map(|j| {
                let one = |k: usize| {
                    let mut values = still();
                    values[j] = if k == 0 { 1.0 } else { 0.0 };
                    given(values)
                };
                frozen.play(SAMPLES, &one)
            })
            .collect();
        let (row, output) = (dice.below(n), dice.below(OUTPUTS.len()));
        // Which sample the signs are for: long enough ago that most of the response counts.
        let signs = |k: usize| -> Vec<f64> {
            let back = SAMPLES - k.min(SAMPLES);
            (0..n)
                .map(|j| kicks[j][back][output][row])
                .map(|h| if h < 0.0 { -1.0 } else { 1.0 })
                .collect()
        };
        let seen = frozen.play(SAMPLES, &|k| given(signs(k)));
        for (o, name) in OUTPUTS.iter().enumerate() {
            for i in 0..n {
                let bound: f64 = bounds[o][i].iter().sum();
                let most = seen.iter().map(|seen| seen[o][i].abs()).fold(0.0, f64::max);
                let ratio = most / bound;
                found.reached = found.reached.max(ratio);
                if ratio.is_nan() || ratio > 1.0 + 1e-9 {
                    found.violations.push(Violation {
                        run: format!(
                            "frozen witness {at}, signs for {} of joint {row}",
                            OUTPUTS[output]
                        ),
                        joint: gains_name(certificate, i),
                        signal: format!(
                            "{name} from {}",
                            if encoder { "encoder" } else { "torque" }
                        ),
                        t_s: SAMPLES as f64 * frozen.period,
                        measured: most,
                        claimed: (0.0, bound),
                        ratio,
                    });
                }
            }
        }
    }
}

fn gains_name(certificate: &Certificate, joint: usize) -> String {
    certificate.joints.get(joint).map(|joint| joint.name.clone()).unwrap_or_default()
}
