//! The loop cut open at the torque: one rational function that does not depend on the inertia.

use nalgebra::Complex;
use phihat::{TorqueSource, VelocitySource};

use super::law::Law;
use super::model::LoopModel;
use super::model::LoopParts;
use super::polynomial::{SampledPolynomial, on_circle};
use crate::JointRecord;

/// `L(z) = N(z)/Δ(z)` of one joint: the closed loop at inertia ratio `μ` has the characteristic
/// polynomial `Δ(z) + N(z)/μ`.
///
/// # Law
///
/// In `w = z − 1`, torque `U` (in units of `M̄`) at the drive's input, drive `X = w + 1 − e^{−ωT}`:
///
/// ```text
/// q = q_n/(w² X) U/μ,    q_n = T²(X − c₁w) + w(T²X/2 − c₂w)            held torque, double integrator
/// y = y_n/(w² X F) U/μ,  y_n = f z T w (X − c₁w)  or  f w q_n/T,  F = w + f      velocity and its filter
/// Δ = w² F (A_o z^{D−l} (z^l − Σ C_r,j z^{l−j}) X − R_a z^{D−d} (X − c₁w)),   N = −z^{D−d} (R_e q_n F + R_v y_n)
/// ```
///
/// The law is `A_o τ = R_e e + R_v q̇ + z R_a τ_acted` besides the `l` torques of the last samples that it uses, see
/// [`Law::transfer`]; `d` counts the samples of both delays, `D = max(d, l)`. A law that receives the torque demanded
/// has `X` in place of `X − c₁w` in `Δ`, one that does not use the velocity has no `F`.
///
/// The loop is cut where the torque meets the inertia: what the observer is told has acted stays known.
#[derive(Debug, Clone, PartialEq)]
pub struct OpenLoop {
    pub(crate) numerator: SampledPolynomial,
    pub(crate) denominator: SampledPolynomial,
    period: f64,
}

impl OpenLoop {
    /// The open loop of one joint's gains in a loop model.
    pub fn new(gains: &JointRecord, model: &LoopModel) -> Self {
        Self::with_drive_gain(gains, model, 1.0)
    }

    /// The same of a law of some order that is at hand.
    pub(crate) fn of_law(law: &Law, order: usize, model: &LoopModel) -> Self {
        let (numerator, denominator) = law.open_loop(model, &OpenPlant::new(model), order);
        Self { numerator, denominator, period: model.period_s }
    }

    /// The same where the drive gives `gain` times the torque that it is told.
    pub(crate) fn with_drive_gain(gains: &JointRecord, model: &LoopModel, gain: f64) -> Self {
        let plant = OpenPlant { gain, ..OpenPlant::new(model) };
        let (numerator, denominator) = open(gains, model, &plant);
        Self { numerator, denominator, period: model.period_s }
    }

    /// The open loop, and the numerator over the same `Δ` from kicks in position of `T²/2`, one at the end of each
    /// sample, to minus the torque. A measured velocity does not see them.
    pub(crate) fn with_kick(gains: &JointRecord, model: &LoopModel) -> (Self, SampledPolynomial) {
        let t = model.period_s;
        let q = SampledPolynomial::new(vec![0.0, 0.5 * t * t]);
        let y = match model.velocity {
            VelocitySource::Measured => SampledPolynomial::new(vec![0.0]),
            VelocitySource::Differenced => q.scaled(model.filter_gain() / t).raised(1),
        };
        let plant = OpenPlant { q, y, ..OpenPlant::new(model) };
        let (kick, _) = open(gains, model, &plant);
        (Self::new(gains, model), kick)
    }

    /// `L(e^{jθ})` at the frequency `θ` \[rad/sample\]; the loop at inertia ratio `μ` is `L/μ`.
    pub fn at_angle(&self, theta: f64) -> Complex<f64> {
        let w = on_circle(theta, 1.0);
        self.numerator.at(w) / self.denominator.at(w)
    }

    /// Sample period \[s\].
    pub fn period(&self) -> f64 {
        self.period
    }

    /// `Δ + N/μ`.
    pub(crate) fn closed(&self, mu: f64) -> SampledPolynomial {
        self.denominator.plus(&self.numerator.scaled(1.0 / mu))
    }
}

/// From held torque to position and velocity at the samples.
struct OpenPlant {
    /// `X`.
    drive: SampledPolynomial,
    /// `X − c₁w`: numerator of the mean torque over `X`.
    mean: SampledPolynomial,
    q: SampledPolynomial,
    y: SampledPolynomial,
    /// `F`.
    filter: SampledPolynomial,
    /// Factor on the torque of the drive.
    gain: f64,
}

impl OpenPlant {
    fn new(model: &LoopModel) -> Self {
        let t = model.period_s;
        let (drive, mean, double) = match model.drive() {
            Some(d) => (
                SampledPolynomial::new(vec![d.lost, 1.0]),
                SampledPolynomial::new(vec![d.lost, 1.0 - d.mean]),
                SampledPolynomial::new(vec![0.0, -d.double]),
            ),
            None => (
                SampledPolynomial::one(),
                SampledPolynomial::one(),
                SampledPolynomial::new(vec![0.0]),
            ),
        };
        let held = drive.scaled(0.5 * t * t).plus(&double);
        let q = mean.scaled(t * t).plus(&held.raised(1));
        let f = model.filter_gain();
        let filtered = SampledPolynomial::new(vec![f, 1.0]);
        let (y, filter) = match (model.velocity, model.filters()) {
            (VelocitySource::Measured, false) => {
                (mean.scaled(t).raised(1), SampledPolynomial::one())
            }
            (VelocitySource::Measured, true) => {
                (mean.times(&SampledPolynomial::z_power(1)).scaled(f * t).raised(1), filtered)
            }
            (VelocitySource::Differenced, _) => (q.scaled(f / t).raised(1), filtered),
        };
        Self { drive, mean, q, y, filter, gain: 1.0 }
    }
}

/// `N` and `Δ`.
fn open(
    gains: &JointRecord,
    model: &LoopModel,
    plant: &OpenPlant,
) -> (SampledPolynomial, SampledPolynomial) {
    Law::or_none(gains, model).open_loop(model, plant, gains.order())
}

impl Law {
    /// `N` and `Δ` around a plant, of a law of some order.
    fn open_loop(
        &self,
        model: &LoopModel,
        plant: &OpenPlant,
        order: usize,
    ) -> (SampledPolynomial, SampledPolynomial) {
        // A law that predicts across a delay follows a ramp only where the loop has that delay; one that is told the
        // torque demanded does not see the drive.
        let rejected = match model.torque {
            _ if self.feed_forward().is_some() => 1,
            TorqueSource::Applied => model.servo_type(order),
            TorqueSource::Demanded => {
                LoopModel { drive_bandwidth_hz: None, ..*model }.servo_type(order)
            }
        };
        let late = model.late() as usize;
        let longer = late.max(self.sent());
        let law = self.transfer(model.period_s);
        let earlier = SampledPolynomial::z_power(longer - late);
        // What acts is reported a sample later, which `Transfer::acted` has taken out.
        let reported = law.acted.times(&earlier);
        let known = |torque: &SampledPolynomial| reported.times(torque).scaled(-1.0);
        let own = law.whole.times(&plant.drive).times(&self.on_sent(longer));
        // What rounding leaves of the lowest coefficients is none; a drive of another gain than 1 adds to them.
        let unknown = match model.torque {
            TorqueSource::Applied => {
                let exact = own.plus(&known(&plant.mean)).without_lowest(rejected);
                exact.plus(&known(&plant.mean).scaled(plant.gain - 1.0))
            }
            TorqueSource::Demanded => own.plus(&known(&plant.drive)).without_lowest(rejected),
        };
        let by_position = law.error.times(&plant.q);
        let (back, unknown) = match &law.velocity {
            Some(velocity) => (
                by_position.times(&plant.filter).plus(&velocity.times(&plant.y)),
                unknown.times(&plant.filter),
            ),
            None => (by_position, unknown),
        };
        (back.times(&earlier).scaled(-plant.gain), unknown.raised(2))
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Complex;
    use phihat::{Form, TorqueSource, VelocitySource};
    use phihat_certificate::{JointRecord, PositionObserver};

    use super::{LoopModel, OpenLoop};
    use crate::lanes::Lane;
    use crate::sampled::control_side::{ControlSide, ControlState};

    const T: f64 = 1e-3;

    /// `−Σ t_k z^{−k}` of what a drive of some gain delivers after an impulse on an inertia that it does not move.
    fn summed(record: &JointRecord, model: &LoopModel, gain: f64, z: Complex<f64>) -> Complex<f64> {
        let side = ControlSide::unit(record, model);
        let mut state = ControlState::<1>::new(&side);
        let (mut sum, mut power) = (Complex::new(0.0, 0.0), Complex::new(1.0, 0.0));
        for k in 0..900_u16 {
            let moving = f64::from(u8::from(k > 0));
            let q = moving * T * T * (f64::from(k) - 0.5);
            let sensed = (&Lane([q]), &Lane([moving * T]));
            let [position, velocity, Lane([acted])] = state.sense(&side, (false, false), sensed);
            let message = [position, velocity, Lane([gain * acted])];
            let command = state.command(&side, false, [0.0; 3], &message);
            let (Lane([mean]), _) = state.act(&side, &command);
            sum -= power * (gain * mean);
            power /= z;
        }
        sum
    }

    #[test]
    fn the_open_loop_is_that_of_the_samples_whatever_the_gain_of_the_drive() {
        let record = |a: Vec<f64>, observer: Option<PositionObserver>| JointRecord {
            name: String::new(),
            inertia_kg_m2: 0.3,
            kp_per_s2: 400.0,
            kd_per_s: 40.0,
            a,
            observer,
        };
        let positions = |delay_samples| PositionObserver {
            correction: vec![0.2028, 15.77, -543.0, -8.4e3],
            share: 0.3,
            delay_samples,
            innovation_filter: Vec::new(),
        };
        let laws = [
            (Form::Observer, record(vec![4900.0, 140.0], None)),
            (Form::Literal, record(vec![4900.0, 140.0], None)),
            (Form::Positions, record(Vec::new(), Some(positions(0)))),
            (Form::Positions, record(Vec::new(), Some(positions(2)))),
        ];
        for (form, record) in laws {
            for (velocity, filter, delay, low_pass) in [
                (VelocitySource::Measured, None, 0, None),
                (VelocitySource::Measured, Some(80.0), 1, Some(60.0)),
                (VelocitySource::Differenced, None, 2, None),
                (VelocitySource::Differenced, Some(50.0), 3, Some(200.0)),
                (VelocitySource::Measured, None, 0, Some(100.0)),
            ] {
                let model = LoopModel {
                    period_s: T,
                    delay_samples: delay,
                    sample_delay_samples: 0,
                    torque: TorqueSource::Applied,
                    velocity,
                    velocity_filter_hz: filter,
                    torque_filter_hz: low_pass,
                    form,
                    drive_bandwidth_hz: None,
                };
                for gain in [1.0, 0.8] {
                    let open = OpenLoop::with_drive_gain(&record, &model, gain);
                    for angle in [0.02, 0.4, 2.0] {
                        let z = Complex::from_polar(1.1, angle);
                        let w = z - 1.0;
                        let ratio = open.numerator.at(w) / open.denominator.at(w);
                        let sum = summed(&record, &model, gain, z);
                        assert!(
                            (sum - ratio).norm() < 1e-8 * ratio.norm(),
                            "{model:?} {gain} {angle}: {sum} {ratio}"
                        );
                    }
                }
            }
        }
    }
}
