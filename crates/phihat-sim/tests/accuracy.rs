//! The plant's integrators are as accurate as they say. Wrong if a stage were misplaced: RK4 must converge
//! at fourth order against the adaptive reference, and an arm left alone must keep its energy.

use phihat_model::{Model, Robot, Workspace};
use phihat_sim::{AccelerationOf, Rk4, integrate_adaptive};

struct FreeArm {
    model: Model,
    workspace: Workspace<f64>,
    tau: Vec<f64>,
}

impl FreeArm {
    fn named(name: &str) -> Self {
        let model = Robot::named(name).unwrap().plant_model();
        let workspace = Workspace::new(&model);
        let tau = vec![0.0; model.joint_count()];
        Self { model, workspace, tau }
    }

    fn energy(&mut self, q: &[f64], dq: &[f64]) -> f64 {
        let kinetic = self.model.kinetic_energy(&mut self.workspace, q, dq);
        kinetic + self.model.potential_energy(&mut self.workspace, q)
    }

    fn start(&self) -> (Vec<f64>, Vec<f64>) {
        let n = self.tau.len();
        let q = (0..n).map(|i| 0.4 * (i as f64 + 1.0).sin()).collect();
        let dq = (0..n).map(|i| 0.5 * (2.0 * i as f64).cos()).collect();
        (q, dq)
    }
}

impl AccelerationOf for FreeArm {
    fn acceleration(&mut self, _t: f64, q: &[f64], dq: &[f64], ddq: &mut [f64]) {
        self.model.forward_dynamics(&mut self.workspace, q, dq, &self.tau, ddq);
    }
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| (x - y).abs()).fold(0.0, f64::max)
}

#[test]
fn rk4_converges_at_fourth_order_to_the_adaptive_reference() {
    for name in ["planar3r", "panda"] {
        let mut arm = FreeArm::named(name);
        let (q0, dq0) = arm.start();
        let (mut exact, mut velocity) = (q0.clone(), dq0.clone());
        integrate_adaptive(&mut arm, (0.0, 0.5), 1e-13, &mut exact, &mut velocity);
        let mut error = |steps: u32| {
            let (mut q, mut dq) = (q0.clone(), dq0.clone());
            let (mut rk4, mut first) = (Rk4::new(q.len()), q.clone());
            let h = 0.5 / f64::from(steps);
            for k in 0..steps {
                rk4.step(&mut arm, (f64::from(k) * h, h), &mut q, &mut dq, &mut first);
            }
            distance(&q, &exact)
        };
        let [coarse, fine, finest] = [20, 40, 80].map(&mut error);
        println!("{name}: {coarse:.2e} {fine:.2e} {finest:.2e}");
        for ratio in [coarse / fine, fine / finest] {
            assert!(
                (13.0..19.0).contains(&ratio),
                "{name}: error ratio {ratio}, 16 is fourth order"
            );
        }
    }
}

#[test]
fn f30_an_arm_left_alone_keeps_its_energy() {
    for name in ["planar3r", "panda"] {
        let mut arm = FreeArm::named(name);
        let (mut q, mut dq) = arm.start();
        let before = arm.energy(&q, &dq);
        let scale = before.abs().max(1.0);
        let (mut rk4, mut first) = (Rk4::new(q.len()), q.clone());
        let h = 1e-4;
        for k in 0..100_000 {
            rk4.step(&mut arm, (f64::from(k) * h, h), &mut q, &mut dq, &mut first);
        }
        let drift = (arm.energy(&q, &dq) - before).abs() / scale;
        println!("{name}: energy drift {drift:.1e} in 10 s at 0.1 ms");
        assert!(drift < 1e-6, "{name}: {drift:e}");
    }
}
