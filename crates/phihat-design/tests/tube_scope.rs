//! Refusal of a tube, with the name of what its loop lacks. Wrong if something that changes the loop were
//! passed over.

use phihat_design::requested_gains;
use phihat_design::tube::{Desired, TubeRefusal, tube};
use phihat_sim::Motion;
use phihat_study::Study;

/// The Panda behind its own interface for a fifth of a second, at a bandwidth \[rad/s\], with more in its world.
fn found(bandwidth: f64, more: &str) -> Result<(), TubeRefusal> {
    let text = format!(
        r#"
duration_s = 0.2
[robot]
name = "panda"
[profile]
name = "robot"
[spec]
settle_s = 0.0
error_bound_rad = 1e-2
[gains]
order = 2
bandwidth_rad_s = {bandwidth:?}
damping = 1.0
estimator_bandwidth_rad_s = 50.0
estimator_damping = 1.0
inertia_kg_m2 = [1.78, 2.22, 1.02, 1.28, 0.247, 0.259, 0.212]
[loop]
rate_hz = 1000.0
delay_samples = 1
[sensor]
velocity = "differenced"
[world]
friction = "robot"
{more}
[reference]
kind = "hold"
q_rad = [0.0, -0.8, 0.0, -2.3, 0.0, 1.6, 0.8]
"#
    );
    let study = Study::from_text(&text, "tube_scope", ".".as_ref()).unwrap();
    let gains = requested_gains(&study).unwrap();
    let motion = Motion::of(&study).unwrap();
    tube(&study, &gains, &Desired::of(&study, |joint, t| motion.told(joint, t))).map(|_| ())
}

#[test]
fn what_the_loop_lacks_is_named() {
    assert_eq!(found(20.0, ""), Ok(()));
    for (more, key) in [
        // What the robot adds is as late as all torque; the loop of a tube has it at once.
        ("drive_bandwidth_hz = 200.0", "world.drive_bandwidth_hz with what the robot adds"),
        ("[world.stiction]\nbreakaway_ratio = 1.5", "world.stiction.breakaway_ratio"),
        ("[world.network]\ncommand_loss = 0.02", "world.network.command_loss"),
    ] {
        assert_eq!(found(20.0, more), Err(TubeRefusal::Unsupported(key.to_owned())), "{more}");
    }
}

#[test]
fn an_unstable_loop_has_no_tube() {
    for bandwidth in [800.0, 1.5e3, 3e3] {
        let found = found(bandwidth, "");
        println!("{bandwidth} rad/s: {found:?}");
        assert!(found.is_err(), "{bandwidth}");
    }
}
