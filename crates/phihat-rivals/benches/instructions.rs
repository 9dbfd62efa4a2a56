//! Workload that `cargo xtask rivals` counts under callgrind: so many updates of one rival on one arm,
//! published gains. `ROBOT RIVAL UPDATES`, where `idle` is the loop without a rival; run as a test it does
//! each rival once on the planar arm.
#![allow(clippy::print_stdout, reason = "a benchmark prints its figures")]
#![allow(clippy::unwrap_used, reason = "a benchmark stops on a bad set-up")]

use std::hint::black_box;

use phihat::InnovationSection;
use phihat_model::Robot;
use phihat_rivals::{All, DesignedJoint, DesignedPosition, RIVALS, Supply, Tuning, rival};

/// Positions and velocities that keep changing, made of nothing that costs much beside an update.
fn triangle(k: u32, joint: usize) -> (f64, f64) {
    let phase = (f64::from(k) * 2e-3 + 0.3 * joint as f64) % 4.0;
    if phase < 2.0 { (0.1 * (phase - 1.0), 0.1) } else { (0.1 * (3.0 - phase), -0.1) }
}

/// A law from positions of order 1.
fn position(inertia: f64) -> DesignedPosition {
    let correction = vec![0.271, 28.5, -1000.0];
    let innovation_filter = Vec::new();
    DesignedPosition { inertia, kp: 400.0, kd: 40.0, correction, share: 0.5, innovation_filter }
}

/// The same with a filter of two sections.
fn filtered(inertia: f64) -> DesignedPosition {
    let section = InnovationSection { rates: [0.02, 0.3], weights: [-200.0, 50.0] };
    DesignedPosition { innovation_filter: vec![section; 2], ..position(inertia) }
}

/// The sum of all torques \[N·m\]; `None` where the rival does not apply.
fn run(robot: &str, id: &str, updates: u32) -> Option<f64> {
    let robot = Robot::named(robot).unwrap();
    let model = robot.plant_model();
    let n = model.joint_count();
    let center = &robot.poses["ready"];
    let inertia = robot.inertia_range(20, 1).mean;
    let first_order = |m: &f64| DesignedJoint { inertia: *m, kp: 400.0, kd: 40.0, a: vec![69.6] };
    let supply = Supply {
        designed_positions: Ok(inertia.iter().copied().map(position).collect()),
        designed_filters: Ok(inertia.iter().copied().map(filtered).collect()),
        designed: Ok(inertia.iter().map(first_order).collect()),
        inertia,
        model: model.with_masses_times(0.8).unwrap(),
        viscous: vec![0.1; n],
        dry: vec![0.2; n],
        torque_max: robot.joints.iter().map(|joint| joint.torque_max).collect(),
        torque_rate_max: None,
        delay_samples: 1,
        task_period: Some(5.0),
        tip: robot.tip.clone(),
        orbit: None,
    };
    let mut running = match rival(id) {
        Some(entry) => {
            let tuning = Tuning::published(entry.scalars, &supply.inertia, 1e-3).unwrap();
            Some(entry.build(&tuning, &supply).ok()?)
        }
        None => None,
    };
    let (mut q, mut dq, mut q_d) = (vec![0.0; n], vec![0.0; n], vec![0.0; n]);
    let (mut tau, ddq_d, clipped) = (vec![0.0; n], vec![0.01; n], vec![false; n]);
    let mut sum = 0.0;
    for k in 0..updates {
        for i in 0..n {
            let (offset, speed) = triangle(k, i);
            (q_d[i], dq[i]) = (center[i] + offset, speed);
            q[i] = q_d[i] + 1e-4;
        }
        let acted = tau.clone();
        let (q, dq, q_d) = (black_box(&q[..]), black_box(&dq[..]), black_box(&q_d[..]));
        let ddq_d = black_box(&ddq_d[..]);
        let all = All {
            q,
            dq,
            tau: &acted,
            commanded: &acted,
            clipped: &clipped,
            q_d,
            dq_d: dq,
            ddq_d,
            ddq_d_acting: ddq_d,
        };
        match &mut running {
            Some(running) => running.update(&all, &mut tau),
            None => _ = black_box(&all),
        }
        sum += tau.iter().sum::<f64>();
    }
    Some(sum)
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match arguments.as_slice() {
        [list] if list == "list" => {
            for entry in RIVALS {
                println!("{}", entry.card.id);
            }
        }
        [robot, id, updates] => {
            println!("{:?}", run(robot, id, updates.parse().unwrap()));
        }
        _ => {
            for entry in RIVALS {
                println!("{}: {:?}", entry.card.id, run("planar3r", entry.card.id, 10));
            }
        }
    }
}
