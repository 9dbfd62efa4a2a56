//! A study's arm, and what acts on it from outside, as a page draws them.

use std::fmt::Write as _;
use std::path::Path;

use phihat_model::{Look, Outline};
use phihat_report::{ArmLink, DrawnArm, DrawnLoad, JointTorque, Plane, PointForce, Surface};
use phihat_study::{Fault, FaultKind, Study};

/// Triangles of a page's arm at most: some 200 kB, and turned smoothly without a graphics processor.
const TRIANGLES: usize = 12_000;
/// Links whose shape could not be read, so many of which are told of one by one.
const TOLD: usize = 3;

/// The arm of a study, and what acts on it, as pages draw it; with the shapes of its description, those in
/// files outside of the folder `within` left out, if one is given.
pub fn arm(study: &Study, within: Option<&Path>) -> DrawnArm {
    let (robot, world) = (&study.robot, &study.world);
    let outline = robot.model.outline();
    let find = |frame: &str| outline.iter().position(|link| link.name == frame);
    let at = |frame: &str| find(frame).unwrap_or_default();
    let tip = at(&robot.tip);
    let look = robot.look(TRIANGLES, within);
    let shapes = look.shapes.iter();
    let shapes =
        shapes.filter_map(|s| Surface::of(find(&s.link)?, &s.points, &s.triangles)).collect();
    let faults = |kind| study.faults.iter().filter(move |fault| fault.kind == kind);
    let own = world.payload.iter().map(|own| DrawnLoad {
        link: at(&own.frame),
        mass: own.mass,
        com: own.com,
        start: own.start,
        end: own.end,
    });
    let picked_up = faults(FaultKind::Payload).map(|fault| DrawnLoad {
        link: tip,
        mass: fault.size,
        com: [0.0; 3],
        start: fault.start,
        end: fault.start + fault.duration,
    });
    let force = |force: &phihat_study::ToolForce| PointForce {
        link: at(&force.frame),
        force: force.force,
        start: force.start,
        end: force.start + force.duration,
    };
    let wall = |wall: &phihat_study::Wall| Plane {
        link: at(&wall.frame),
        point: wall.point,
        normal: wall.normal,
    };
    DrawnArm {
        gravity: world.gravity,
        tip,
        payloads: own.chain(picked_up).collect(),
        torques: torques(study, faults(FaultKind::Push)),
        forces: world.forces.iter().map(force).collect(),
        walls: world.walls.iter().map(wall).collect(),
        looks: told(&look),
        shapes,
        links: outline.into_iter().map(link).collect(),
    }
}

/// Text about the shapes of a description: those that are drawn, and those that are missing.
fn told(look: &Look) -> String {
    let Look { shapes, missing, triangles_read } = look;
    let drawn: usize = shapes.iter().map(|shape| shape.triangles.len()).sum();
    let mut text = match (shapes.len(), missing.len()) {
        (0, 0) => return String::new(),
        (0, _) => "None of the shapes of its URDF could be read.".to_owned(),
        (links, _) if drawn < *triangles_read => format!(
            "Drawn with the shapes that its URDF gives {links} links, {triangles_read} triangles, thinned to {drawn}."
        ),
        (links, _) => {
            format!("Drawn with the shapes that its URDF gives {links} links, {drawn} triangles.")
        }
    };
    for (link, why) in missing.iter().take(TOLD) {
        // Writing to a string cannot fail.
        let _ = write!(text, " Not read, of {link}: {why}.");
    }
    if missing.len() > TOLD {
        let _ = write!(text, " And {} more.", missing.len() - TOLD);
    }
    text
}

fn link(outline: Outline) -> ArmLink {
    let Outline { name, parent, joint, slides, pose, axis, body } = outline;
    let (mass, com) = (body.mass, body.com);
    ArmLink { name, parent, joint, slides, p: pose.p, r: pose.r, axis, mass, com }
}

fn torques<'a>(study: &Study, faults: impl Iterator<Item = &'a Fault>) -> Vec<JointTorque> {
    let own = study.world.pushes.iter().map(|push| JointTorque {
        joint: push.joint,
        torque: push.torque,
        start: push.start,
        end: push.start + push.duration,
    });
    let joints = 0..study.robot.joints.len();
    let of_fault = faults.flat_map(|fault| {
        let concerned = joints.clone().filter(|joint| fault.concerns(*joint));
        concerned.map(|joint| JointTorque {
            joint,
            torque: fault.size,
            start: fault.start,
            end: fault.start + fault.duration,
        })
    });
    own.chain(of_fault).collect()
}

#[cfg(test)]
mod tests {
    use phihat_model::{Robot, Workspace};
    use phihat_study::Study;

    use super::arm;

    #[test]
    fn a_page_puts_every_link_where_the_model_has_it() {
        for name in ["panda", "iiwa14", "ur5", "planar3r"] {
            let text = format!(
                "duration_s = 2.0\n[robot]\nname = \"{name}\"\n[spec]\nsettle_s = 1.0\nerror_bound_rad = \
                    2e-3\n[gains]\norder = 1\nbandwidth_rad_s = 20.0\nestimator_bandwidth_rad_s = 70.0\ninertia_kg_m2 \
                    = 1.0\n[reference]\nkind = \"sines\"\ncenter = \"ready\"\nfade_in_s = \
                    1.0\n[[reference.sine]]\namplitude_rad = 0.01\nfrequency_hz = 0.1\n"
            );
            let study = Study::from_text(&text, "study.toml", "".as_ref()).unwrap();
            let model = Robot::named(name).unwrap().model;
            let (mut ws, arm) = (Workspace::new(&model), arm(&study, None));
            for k in 0..20 {
                let q: Vec<f64> = (0..model.joint_count())
                    .map(|j| f64::from(3 * k).sin() * (1.0 + j as f64))
                    .collect();
                model.forward_kinematics(&mut ws, &q);
                for (link, drawn) in arm.links.iter().zip(arm.origins(&q)) {
                    let true_p = model.pose(&ws, model.frame(&link.name).unwrap()).p;
                    assert!(
                        drawn.iter().zip(true_p).all(|(a, b)| (a - b).abs() < 1e-12),
                        "{name} {}",
                        link.name
                    );
                }
            }
            assert_eq!(arm.links[arm.tip].name, study.robot.tip);
        }
    }
}
