//! Every reference is twice continuously differentiable, and goes where it says. Wrong if a derivative did
//! not belong to its function, or a junction had a jump.

use std::fmt::Write as _;

use phihat_model::Workspace;
use phihat_sim::Motion;
use phihat_study::Study;

const HEAD: &str = "duration_s = 6.0\n[robot]\nname = \"ROBOT\"\n[gains]\norder = 2\n\
                    bandwidth_rad_s = 20.0\ndamping = 1.0\nestimator_bandwidth_rad_s = 70.0\n\
                    estimator_damping = 1.0\ninertia_kg_m2 = 1.0\n[reference]\n";

const SINES: &str = "kind = \"sines\"\ncenter_rad = [0.0, 0.1, 0.2, -1.5, 0.0, 1.5, 0.3]\nfade_in_s = 1.5\n\
                     [[reference.sine]]\namplitude_rad = 0.2\nfrequency_hz = 0.3\nphase_rad = 0.5\n\
                     [[reference.sine]]\namplitude_rad = 0.05\nfrequency_hz = 0.7\nphase_rad = 0.0\n";

const WAYPOINTS: &str = "kind = \"waypoints\"\n\
    [[reference.waypoint]]\nt_s = 0.0\nq_rad = [0.0, 0.1, 0.2, -1.5, 0.0, 1.5, 0.3]\n\
    [[reference.waypoint]]\nt_s = 1.5\nq_rad = [0.4, 0.3, 0.0, -1.1, 0.2, 1.7, 0.1]\n\
    [[reference.waypoint]]\nt_s = 4.0\nq_rad = [0.0, 0.0, -0.4, -1.9, 0.1, 1.2, 0.9]\n";

const CIRCLE: &str = "kind = \"circle\"\nframe = \"panda_link8\"\ncenter_m = [0.5, 0.0, 0.45]\n\
                      radius_m = 0.1\nnormal = [0.0, 0.6, 0.8]\nperiod_s = 3.0\nfade_in_s = 1.0\n\
                      hold_orientation = true\nseed = \"ready\"\n";

const CURVE: &str = "kind = \"curve\"\nframe = \"tool\"\n\
                     points_m = [[0.6, 0.0, 0.1], [0.5, 0.0, 0.3], [0.3, 0.0, 0.3], [0.3, 0.0, 0.1]]\n\
                     period_s = 4.0\nfade_in_s = 1.0\nseed_rad = [0.3, 0.8, 0.4]\n";

fn study(robot: &str, reference: &str) -> Study {
    crate::support::read(&(HEAD.replace("ROBOT", robot) + reference))
}

fn motion(study: &Study) -> Motion {
    Motion::new(&study.reference, &study.robot, study.duration).unwrap()
}

#[test]
fn derivatives_belong_to_their_function_and_nothing_jumps() {
    let cases = [("panda", SINES), ("panda", WAYPOINTS), ("panda", CIRCLE), ("planar3r", CURVE)];
    for (robot, reference) in cases {
        let study = study(robot, reference);
        let motion = motion(&study);
        let h = 1e-5;
        for joint in 0..study.robot.joints.len() {
            let mut previous: Option<f64> = None;
            for k in 1..5990 {
                let t = f64::from(k) * 1e-3 + 0.000_37;
                let [_, dq, ddq] = motion.at(joint, t);
                let (before, after) = (motion.at(joint, t - h), motion.at(joint, t + h));
                let slope = (after[0] - before[0]) / (2.0 * h);
                let bend = (after[1] - before[1]) / (2.0 * h);
                assert!(
                    (slope - dq).abs() < 1e-5,
                    "{reference}joint {joint}, t = {t}: {slope} {dq}"
                );
                assert!(
                    (bend - ddq).abs() < 2e-3,
                    "{reference}joint {joint}, t = {t}: {bend} {ddq}"
                );
                // A millisecond changes the acceleration of these motions by little.
                let jump = previous.map_or(0.0, |p| (ddq - p).abs());
                assert!(jump < 0.1, "{reference}joint {joint}, t = {t}: q̈ jumps by {jump}");
                previous = Some(ddq);
            }
        }
    }
}

#[test]
fn waypoints_are_met_at_rest_and_the_last_one_held() {
    let study = study("panda", WAYPOINTS);
    let motion = motion(&study);
    for (t, expected) in [(0.0, 0.1), (1.5, 0.3), (4.0, 0.0), (5.5, 0.0)] {
        let [q, dq, ddq] = motion.at(1, t);
        assert!((q - expected).abs() < 1e-12 && dq.abs() < 1e-12 && ddq.abs() < 1e-9, "t = {t}");
    }
}

#[test]
fn the_tool_runs_on_its_circle_with_its_orientation_held() {
    let study = study("panda", CIRCLE);
    let motion = motion(&study);
    let model = &study.robot.model;
    let mut workspace = Workspace::new(model);
    let frame = model.frame("panda_link8").unwrap();
    let mut pose_at = |t: f64| {
        let q: Vec<f64> = (0..7).map(|j| motion.at(j, t)[0]).collect();
        model.forward_kinematics(&mut workspace, &q);
        model.pose(&workspace, frame)
    };
    let start = pose_at(0.0);
    let (mut lowest, mut highest) = (f64::INFINITY, f64::NEG_INFINITY);
    for k in 0..6000 {
        let pose = pose_at(f64::from(k) * 1e-3);
        let from = [pose.p[0] - 0.5, pose.p[1], pose.p[2] - 0.45];
        let radius = from.iter().map(|x| x * x).sum::<f64>().sqrt();
        let above = from[1] * 0.6 + from[2] * 0.8;
        assert!((radius - 0.1).abs() < 2e-6 && above.abs() < 2e-6, "sample {k}: {radius} {above}");
        let turned = (0..3).flat_map(|i| (0..3).map(move |j| (i, j)));
        let most = turned.map(|(i, j)| (pose.r[i][j] - start.r[i][j]).abs()).fold(0.0, f64::max);
        assert!(most < 1e-5, "sample {k}: the orientation turns by {most}");
        (lowest, highest) = (lowest.min(pose.p[0]), highest.max(pose.p[0]));
    }
    assert!(highest - lowest > 0.199, "it must go all the way round");
    // One turn takes 3 s, half a second more for the soft start.
    let (one, two) = (pose_at(2.0), pose_at(5.0));
    assert!((0..3).all(|i| (one.p[i] - two.p[i]).abs() < 2e-6));
}

/// Wrong if the spline's free end reached into the run.
#[test]
fn a_longer_run_has_the_same_reference_up_to_the_end_of_the_shorter() {
    for (robot, reference) in [("panda", CIRCLE), ("planar3r", CURVE)] {
        let study = study(robot, reference);
        let of = |duration| Motion::new(&study.reference, &study.robot, duration).unwrap();
        let (short, long) = (of(6.0), of(7.0));
        for joint in 0..study.robot.joints.len() {
            for k in 5900..6000 {
                let t = f64::from(k) * 1e-3;
                let apart = (short.at(joint, t)[2] - long.at(joint, t)[2]).abs();
                assert!(apart < 1e-6, "{robot}, joint {joint}, t = {t}: q̈ differs by {apart}");
            }
        }
    }
}

#[test]
fn a_circle_out_of_reach_is_refused_with_time_and_place() {
    let far = CIRCLE.replace("[0.5, 0.0, 0.45]", "[0.8, 0.0, 0.45]");
    let study = study("panda", &far);
    let error =
        Motion::new(&study.reference, &study.robot, 6.0).map(|_| ()).unwrap_err().to_string();
    assert!(error.contains("cannot be reached") && error.contains("t ="), "{error}");
}

/// Setpoints at random times, at most as far apart as is stated, within the joints' travel; one row per setpoint.
fn setpoints(rng: &mut impl FnMut() -> f64, (least, most): (f64, f64)) -> String {
    let mut text = "kind = \"setpoints\"\nspeed_max_rad_s = [1.0, 0.4, 2.0]\nacceleration_max_rad_s2 = [4.0, 2.0, \
                    9.0]\njerk_max_rad_s3 = [60.0, 20.0, 200.0]\n"
        .to_owned();
    let mut t = 0.0;
    for _ in 0..4000 {
        let q: Vec<f64> = (0..3).map(|_| 2.0 * rng() - 1.0).collect();
        let _ = write!(text, "[[reference.setpoint]]\nt_s = {t:?}\nq_rad = {q:?}\n");
        t += least + (most - least) * rng();
        if t > 4.0 {
            break;
        }
    }
    text
}

/// Limits hold at all times, between steps too, whatever comes; a setpoint does nothing before its time; the last is
/// reached.
#[test]
fn setpoints_are_followed_within_limits_and_not_foreseen() {
    let mut state = 7_u64;
    let mut rng = || {
        state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    for (least, most) in [(0.001, 0.01), (0.05, 0.2), (0.8, 3.0)] {
        let text = setpoints(&mut rng, (least, most));
        let mut study = study("planar3r", &text);
        // The slowest way takes 5.3 s.
        study.duration = 12.0;
        let motion = motion(&study);
        let phihat_study::ReferenceRequest::Setpoints { t, q, limits, .. } = &study.reference
        else {
            panic!("setpoints")
        };
        // The same but for the last: nothing is otherwise before its time.
        let mut other = study.clone();
        if let phihat_study::ReferenceRequest::Setpoints { q, .. } = &mut other.reference {
            q.last_mut().unwrap().iter_mut().for_each(|q| *q = -*q);
        }
        let other = Motion::new(&other.reference, &other.robot, other.duration).unwrap();
        let last = *t.last().unwrap();
        for (joint, [speed, acceleration, jerk]) in limits.iter().enumerate() {
            let h = 2e-4;
            for k in 0..30_000 {
                let time = f64::from(k) * h;
                let [q, dq, ddq] = motion.at(joint, time);
                let next = motion.at(joint, time + h);
                // The integral of the acceleration, by Simpson's rule: exact for a line.
                let middle = motion.at(joint, time + 0.5 * h);
                let moved = h / 6.0 * (ddq + 4.0 * middle[2] + next[2]);
                assert!((next[1] - dq - moved).abs() < 1e-9, "{text}joint {joint}, t = {time}");
                let moved = h / 6.0 * (dq + 4.0 * middle[1] + next[1]);
                assert!((next[0] - q - moved).abs() < 1e-9, "{text}joint {joint}, t = {time}");
                assert!(
                    dq.abs() <= speed * (1.0 + 1e-9) && ddq.abs() <= acceleration * (1.0 + 1e-9)
                );
                assert!((next[2] - ddq).abs() <= jerk * h * (1.0 + 1e-6), "{text}{joint} {time}");
                if time < last {
                    let same = motion.at(joint, time).map(f64::to_bits);
                    assert_eq!(same, other.at(joint, time).map(f64::to_bits));
                }
            }
            let [end, ..] = motion.at(joint, 11.9);
            assert!((end - q.last().unwrap()[joint]).abs() < 1e-2, "{text}joint {joint}: {end}");
        }
    }
}

/// A step of a joint alone, against the least time of a motion within speed, acceleration and jerk, in closed form.
#[test]
fn a_step_arrives_soon_and_does_not_overshoot() {
    let text = "kind = \"setpoints\"\nspeed_max_rad_s = 1.0\nacceleration_max_rad_s2 = 4.0\njerk_max_rad_s3 = 60.0\n\
                [[reference.setpoint]]\nt_s = 0.0\nq_rad = [0.0, 0.0, 0.0]\n[[reference.setpoint]]\nt_s = 0.5\nq_rad = \
                [0.8, 0.1, -0.01]\n";
    let study = study("planar3r", text);
    let motion = motion(&study);
    let (v, a, j) = (1.0_f64, 4.0_f64, 60.0_f64);
    for (joint, way) in [0.8_f64, 0.1, 0.01].into_iter().enumerate() {
        // Full speed; full acceleration without full speed; neither.
        let ramp = v / a + a / j;
        let least = if way >= v * ramp {
            way / v + ramp
        } else if way >= 2.0 * a * (a / j).powi(2) {
            let t = a / j;
            t + (t * t + 4.0 * way / a).sqrt()
        } else {
            4.0 * (way / (2.0 * j)).cbrt()
        };
        let sign = if joint == 2 { -1.0 } else { 1.0 };
        let at = |t: f64| sign * motion.at(joint, 0.5 + t)[0];
        assert!(
            (0..5000).all(|k| at(1e-3 * f64::from(k)) <= way + 1e-4),
            "joint {joint} overshoots"
        );
        let near = (0..5000).find(|k| (at(1e-3 * f64::from(*k)) - way).abs() < 0.01 * way);
        let ratio = 1e-3 * f64::from(near.unwrap()) / least;
        eprintln!("joint {joint}: within 1 % after {ratio:.2} of the least time");
        assert!(ratio < 2.0, "joint {joint}: {ratio}");
    }
}
