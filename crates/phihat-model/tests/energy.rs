//! Power is the rate of energy, kinetic energy is `½ q̇ᵀ M q̇`, and `Ṁ − 2 C` takes no power. Wrong
//! if a Coriolis term has a wrong sign or factor.

use crate::support::{Random, dot, mass_matrix, models, times};
use phihat_model::{Model, Workspace};

/// Step of central differences \[s\]: truncation and rounding both stay below 1e-7.
const STEP: f64 = 1e-5;

fn energy(model: &Model, ws: &mut Workspace, q: &[f64], dq: &[f64]) -> f64 {
    model.kinetic_energy(ws, q, dq) + model.potential_energy(ws, q)
}

fn moved(x: &[f64], dx: &[f64], t: f64) -> Vec<f64> {
    x.iter().zip(dx).map(|(x, dx)| x + t * dx).collect()
}

#[test]
fn power_of_the_torque_is_the_rate_of_energy() {
    let mut random = Random(4);
    for model in models() {
        let n = model.joint_count();
        let armature: Vec<f64> = (0..n).map(|_| random.within(0.0, 0.3)).collect();
        let model = model.with_armature(&armature).unwrap();
        let mut ws = Workspace::new(&model);
        for _ in 0..20 {
            let (q, dq, tau) =
                (random.vector(n, 2.0), random.vector(n, 2.0), random.vector(n, 9.0));
            let mut ddq = vec![0.0; n];
            model.forward_dynamics(&mut ws, &q, &dq, &tau, &mut ddq);
            let mut at = |t: f64| {
                let half = moved(&moved(&q, &dq, t), &ddq, 0.5 * t * t);
                energy(&model, &mut ws, &half, &moved(&dq, &ddq, t))
            };
            let rate = (at(STEP) - at(-STEP)) / (2.0 * STEP);
            let power = dot(&tau, &dq);
            let scale = power.abs() + dot(&dq, &dq) * 10.0;
            assert!((rate - power).abs() < 1e-6 * scale, "{rate} {power}");
        }
    }
}

#[test]
fn kinetic_energy_is_half_the_square_of_the_speed_in_m() {
    let mut random = Random(5);
    for model in models() {
        let (n, mut ws) = (model.joint_count(), Workspace::new(&model));
        let (q, dq) = (random.vector(n, 2.0), random.vector(n, 2.0));
        let expected = 0.5 * dot(&dq, &times(&mass_matrix(&model, &mut ws, &q), &dq));
        let found = model.kinetic_energy(&mut ws, &q, &dq);
        assert!((found - expected).abs() < 1e-12 * expected);
    }
}

#[test]
fn change_of_inertia_less_twice_coriolis_takes_no_power() {
    let mut random = Random(6);
    for model in models() {
        let (n, mut ws) = (model.joint_count(), Workspace::new(&model));
        let (q, dq) = (random.vector(n, 2.0), random.vector(n, 2.0));
        let mut along = |t: f64| {
            let m = mass_matrix(&model, &mut ws, &moved(&q, &dq, t));
            dot(&dq, &times(&m, &dq))
        };
        let change = (along(STEP) - along(-STEP)) / (2.0 * STEP);
        let (mut bias, mut gravity) = (vec![0.0; n], vec![0.0; n]);
        model.bias(&mut ws, &q, &dq, &mut bias);
        model.gravity_torque(&mut ws, &q, &mut gravity);
        let twice = 2.0 * (dot(&bias, &dq) - dot(&gravity, &dq));
        assert!((change - twice).abs() < 1e-6 * (1.0 + change.abs()), "{change} {twice}");
    }
}
