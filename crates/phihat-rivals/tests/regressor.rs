//! The regressor's momentum form and its identifiable columns.

use crate::support::Bench;
use phihat_model::Workspace;
use phihat_rivals::{Knows, Regressor};

/// The true parameters in the regressor's order.
fn parameters(bench: &Bench) -> Vec<f64> {
    let links = bench.plant.dynamic_parameters();
    let rotors = bench.plant.armature().iter();
    links.as_flattened().iter().chain(rotors).chain(&bench.friction.0).copied().collect()
}

fn times(matrix: &[f64], theta: &[f64]) -> Vec<f64> {
    let rows = matrix.chunks(theta.len());
    rows.map(|row| row.iter().zip(theta).map(|(y, t)| y * t).sum()).collect()
}

#[test]
fn the_momentum_form_is_that_of_the_energy() {
    for arm in ["planar3r", "panda"] {
        let bench = Bench::arm(arm);
        let n = bench.supply.joints();
        let mut regressor = Regressor::of(&bench.supply).unwrap();
        let mut ws = Workspace::new(&bench.plant);
        let q: Vec<_> = (0..n).map(|i| bench.center[i] + 0.1 * i as f64).collect();
        let v: Vec<_> = (0..n).map(|i| 0.8 - 0.3 * i as f64).collect();
        let theta = parameters(&bench);
        let mut out = vec![0.0; n * regressor.parameters()];
        regressor.momentum(&q, &v, &mut out);
        let momentum = times(&out, &theta);
        regressor.momentum_rate(&q, &v, &mut out);
        let rate = times(&out, &theta);
        let (mut m, mut gravity) = (vec![0.0; n * n], vec![0.0; n]);
        bench.plant.mass_matrix(&mut ws, &q, &mut m);
        bench.plant.gravity_torque(&mut ws, &q, &mut gravity);
        for k in 0..n {
            let p: f64 = (0..n).map(|j| m[k * n + j] * v[j]).sum();
            assert!((momentum[k] - p).abs() < 1e-12 * (1.0 + p.abs()), "{arm} {k}");
            // C(q, v)ᵀ v = ∂T/∂q, by a difference of the energy itself.
            let mut energy = |h: f64| {
                let mut moved = q.clone();
                moved[k] += h;
                bench.plant.kinetic_energy(&mut ws, &moved, &v)
            };
            let slope = (energy(1e-5) - energy(-1e-5)) / 2e-5;
            let expected = -slope + gravity[k] + bench.friction.0[k] * v[k];
            assert!((rate[k] - expected).abs() < 1e-7, "{arm} {k}: {} {expected}", rate[k]);
        }
    }
}

/// Planar, upright, lengths known: three moments of inertia, two first moments of each of three links, two
/// rotors (the first turns with the first link), three frictions. Panda: 43 base parameters (Gaz, Cognetti,
/// Oliva, Robuffo Giordano, De Luca, 2019), five rotors (the second axis meets the first, which is vertical, at a
/// right angle: its rotor turns with its link too), seven frictions.
#[test]
fn as_many_columns_are_identifiable_as_is_known() {
    for (arm, count) in [("planar3r", 14), ("panda", 43 + 5 + 7)] {
        let bench = Bench::arm(arm);
        let columns = Regressor::of(&bench.supply).unwrap().identifiable();
        assert_eq!(columns.len(), count, "{arm}: {columns:?}");
    }
}
