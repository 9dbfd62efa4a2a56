//! Published descriptions: which of them load, whole or as the chain that is proposed, and their torque and
//! mass matrix at some states, for an independent computation.
//!
//! `cargo xtask zoo`, or `cargo run -p phihat-model --example zoo < LIST`: one path of a file per line in,
//! one JSON document per line out.
#![forbid(unsafe_code)]

use std::error::Error;
use std::io::{BufRead as _, Write as _, stdin, stdout};
use std::path::Path;

use phihat_model::{Chain, JointKind, Part, Robot, Workspace};
use serde_json::{Value, json};

/// States of each arm.
const STATES: usize = 5;

fn main() -> Result<(), Box<dyn Error>> {
    for line in stdin().lock().lines() {
        writeln!(stdout(), "{}", examined(Path::new(&line?)))?;
    }
    Ok(())
}

/// Result of one file.
fn examined(path: &Path) -> Value {
    let chains = Robot::chains(path).unwrap_or_default();
    let chain = |c: &Chain| json!({ "base": c.base, "tip": c.tip, "joints": c.joints });
    let listed: Vec<Value> = chains.iter().map(chain).collect();
    let whole = Robot::read(path);
    let (robot, how, why) = match (whole, chains.first()) {
        (Ok(robot), _) => (Some(robot), "whole", Value::Null),
        (Err(why), None) => (None, "no", json!(why.to_string())),
        (Err(why), Some(first)) => {
            let part = Part {
                base: Some(first.base.clone()),
                tip: Some(first.tip.clone()),
                ..Part::default()
            };
            let all = format!("{why}");
            match Robot::read_part(path, &part) {
                Ok(robot) => (Some(robot), "chain", json!(all)),
                Err(why) => (None, "no", json!(why.to_string())),
            }
        }
    };
    json!({
        "loads": how,
        "why": why,
        "chains": listed,
        "robot": robot.as_ref().map(about),
        "states": robot.as_ref().map(states),
    })
}

fn about(robot: &Robot) -> Value {
    let kind = |kind: JointKind| match kind {
        JointKind::Revolute => "revolute",
        JointKind::Continuous => "continuous",
        JointKind::Prismatic => "prismatic",
    };
    json!({
        "tip": robot.tip,
        "joints": robot.model.joint_names(),
        "kinds": robot.joints.iter().map(|joint| kind(joint.kind)).collect::<Vec<_>>(),
        "held": robot.held,
        "warnings": robot.warnings,
    })
}

/// Torque and mass matrix at states that are drawn alike on every machine.
fn states(robot: &Robot) -> Vec<Value> {
    let n = robot.joints.len();
    let mut seed: u64 = 1;
    let mut draw = |scale: f64| -> Vec<f64> {
        let mut one = || {
            // The generator of Knuth's MMIX.
            seed = seed
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            scale * ((seed >> 40) as f64 / f64::from(1 << 23) - 1.0)
        };
        (0..n).map(|_| one()).collect()
    };
    let mut workspace = Workspace::new(&robot.model);
    let one = |_| {
        let (q, dq, ddq) = (draw(2.5), draw(2.0), draw(10.0));
        let (mut tau, mut mass) = (vec![0.0; n], vec![0.0; n * n]);
        robot.model.inverse_dynamics(&mut workspace, &q, &dq, &ddq, &mut tau);
        robot.model.mass_matrix(&mut workspace, &q, &mut mass);
        json!({ "q": q, "dq": dq, "ddq": ddq, "tau": tau, "mass": mass })
    };
    (0..STATES).map(one).collect()
}
