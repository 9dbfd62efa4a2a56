//! The state matrix is the implementation: core, sensor, delay, drive and an exactly solved inertia, for
//! every order, form, velocity source, filter, delay and drive. Wrong if a sign, a delay by one sample or a
//! coefficient differed anywhere between the equations here and the code that runs.

use crate::sampled_support::{Outside, Random, Rig, estimator, every_model, record};
use nalgebra::{Complex, DVector};
use phihat::Reference;
use phihat_design::sampled::{OpenLoop, StateMatrix};

/// Share of the largest value so far by which a trajectory may differ: rounding, summed.
const TOLERANCE: f64 = 1e-10;

#[test]
fn trajectories_are_those_of_the_core() {
    let mut random = Random(1);
    let mut worst = 0.0_f64;
    for model in every_model() {
        for order in 1..=4 {
            let w = random.between(20.0, 60.0);
            let gains = record(150.0, 25.0, &estimator(order, w, 1.0), 0.7);
            let mu = random.between(0.9, 1.6);
            let matrix = StateMatrix::new(&gains, &model, mu);
            let mut rig = Rig::new(&gains, &model, mu);
            let mut x = DVector::<f64>::zeros(matrix.matrix().nrows());
            let (mut scale_q, mut scale_u) = (0.0_f64, 0.0_f64);
            for k in 0..400 {
                let mut noise = |size: f64| size * (2.0 * random.unit() - 1.0);
                let outside = Outside {
                    phi: noise(3.0),
                    phi_slope: 0.0,
                    encoder: noise(1e-4),
                    reference: Reference { q: noise(0.1), dq: noise(0.3), ddq: noise(2.0) },
                };
                let inputs = [
                    (matrix.encoder(), outside.encoder),
                    (&matrix.reference()[0], outside.reference.q),
                    (&matrix.reference()[1], outside.reference.dq),
                    (&matrix.reference()[2], outside.reference.ddq),
                ];
                let mut u = (&matrix.encoder().state * &x)[0];
                let mut next = matrix.matrix() * &x + matrix.disturbance() * (outside.phi / 0.7);
                for (reaction, value) in inputs {
                    u += reaction.direct * value;
                    next += &reaction.drives * value;
                }
                let command = rig.step(&outside);
                x = next;
                scale_q = scale_q.max(rig.q.abs());
                scale_u = scale_u.max(u.abs());
                let error = (x[0] - rig.q).abs() / scale_q.max(1e-9)
                    + (u - command.tau / 0.7).abs() / scale_u.max(1e-9);
                worst = worst.max(error);
                assert!(error < TOLERANCE, "{model:?}, m = {order}, sample {k}: {error:e}");
            }
        }
    }
    println!("worst relative difference {worst:.1e}");
}

#[test]
fn the_open_loop_is_the_same_loop() {
    // On the unit circle det(z − A) and Δ + N/μ have the same zeros; compared through
    // 1 + L/μ = det(z − A(μ)) / det(z − A(∞)).
    let mut random = Random(2);
    for model in every_model() {
        for order in 1..=4 {
            let w = random.between(20.0, 90.0);
            let gains = record(400.0, 40.0, &estimator(order, w, 0.8), 1.0);
            let open = OpenLoop::new(&gains, &model);
            for theta in [0.02, 0.1, 0.5, 1.5, 3.0] {
                let mu = random.around(0.1, 10.0);
                let at = |mu: f64| {
                    let a = StateMatrix::new(&gains, &model, mu).matrix().map(Complex::from);
                    let n = a.nrows();
                    let z = Complex::from_polar(1.0, theta);
                    (nalgebra::DMatrix::identity(n, n) * z - a).determinant()
                };
                let ratio = at(mu) / at(1e300);
                let wanted = open.at_angle(theta) / mu + 1.0;
                let error = (ratio - wanted).norm() / wanted.norm();
                assert!(error < 1e-6, "{model:?} m {order} θ {theta}: {ratio} {wanted}");
            }
        }
    }
}
