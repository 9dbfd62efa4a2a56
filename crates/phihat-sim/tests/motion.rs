//! Every reference is twice continuously differentiable, and goes where it says. Wrong if a derivative did
//! not belong to its function, or a junction had a jump.

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
