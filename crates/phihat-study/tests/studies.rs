//! The studies that come with the project are read, and mean what they say.
//!
//! Wrong if a published study is refused, or if a key's value does not arrive at its field.

use crate::support::{GOOD, read, studies, with_line, with_reference};
use phihat::{Form, VelocitySource};
use phihat_study::{
    Curve, JointSprings, LawRequest, Payload, Push, ReferenceRequest, Start, Study,
};

#[test]
fn every_published_study_is_read() {
    for path in studies() {
        let study = Study::read(&path).unwrap_or_else(|error| panic!("{}", error.render()));
        assert_eq!(study.name, path.file_stem().unwrap().to_str().unwrap());
        assert_ne!(study.title, study.name, "a published study has a title");
        assert!(study.spec.error_bound.is_some(), "{}: states no error bound", study.name);
        let inertia = study.gains.as_ref().map_or(study.robot.joints.len(), |g| g.inertia.len());
        assert_eq!(inertia, study.robot.joints.len());
    }
}

#[test]
fn what_is_not_said_has_its_default() {
    let study = read(
        "duration_s = 2.0\n[robot]\nname = 'planar3r'\n[gains]\nbandwidth_rad_s = 10\n\
         estimator_bandwidth_rad_s = 30\ninertia_kg_m2 = 1\n[reference]\nkind = 'hold'\nq_rad = 0.1\n",
    )
    .unwrap();
    assert_eq!((study.name.as_str(), study.title.as_str(), study.seed), ("base", "base", 0));
    assert_eq!(study.spec.settle.to_bits(), 1.0_f64.to_bits());
    assert_eq!((&study.spec.error_bound, &study.spec.error_integral_bound), (&None, &None));
    assert_eq!(study.spec.velocity_error_bound, None);
    let law = LawRequest::Bandwidths {
        order: vec![2; 3],
        bandwidth: vec![10.0; 3],
        damping: vec![1.0; 3],
        estimator_bandwidth: vec![30.0; 3],
        estimator_damping: vec![1.0; 3],
        torque_bandwidth: None,
    };
    let gains = study.gains.unwrap();
    assert_eq!((gains.inertia, gains.law), (vec![1.0; 3], law));
    let control = &study.control;
    assert_eq!((control.period_ns, control.delay_samples), (1_000_000, 0));
    assert_eq!(control.form, Form::Observer);
    assert_eq!(control.torque_max, Some(vec![50.0; 3]), "the robot's own limit");
    assert_eq!(control.torque_rate_max, None);
    assert_eq!(study.sensor.encoder_bits, None);
    assert_eq!(study.sensor.velocity, VelocitySource::Measured);
    assert_eq!(study.sensor.velocity_filter_hz, None);
    let world = &study.world;
    assert_eq!(world.gravity.map(f64::to_bits), [0.0, 0.0, -9.81].map(f64::to_bits));
    assert!(world.robot_friction && world.pushes.is_empty());
    assert_eq!((&world.extra_coulomb, &world.extra_viscous), (&vec![0.0; 3], &vec![0.0; 3]));
    assert_eq!((&world.drive_bandwidth_hz, &world.payload, &world.start), (&None, &None, &None));
    assert_eq!(world.substeps, 1);
    assert_eq!(
        study.reference,
        ReferenceRequest::Waypoints { t: vec![0.0], q: vec![vec![0.1; 3]] }
    );
}

#[test]
fn what_is_said_arrives() {
    let study = read(GOOD).unwrap();
    assert_eq!((study.title.as_str(), study.seed), ("base", 3));
    assert_eq!(study.text, GOOD);
    assert_eq!(study.spec.error_bound, Some(vec![1e-3; 3]));
    assert_eq!(study.gains.unwrap().inertia, [0.42, 0.18, 0.14]);
    assert_eq!(study.control.delay_samples, 1);
    assert_eq!(study.sensor.encoder_bits, Some(vec![18; 3]));
    assert_eq!(study.sensor.velocity, VelocitySource::Differenced);
    assert_eq!(study.world.extra_coulomb, [0.1; 3]);
    let payload = Payload {
        frame: "tool".into(),
        mass: 0.3,
        com: [0.0; 3],
        inertia: [0.0; 6],
        start: 0.0,
        end: f64::INFINITY,
    };
    assert_eq!(study.world.payload, Some(payload));
    let push = Push { joint: 1, torque: 3.0, start: 2.0, duration: 0.2 };
    assert_eq!(study.world.pushes, [push]);
    let ReferenceRequest::Sines { center, terms, fade_in } = study.reference else {
        panic!("sines")
    };
    assert_eq!(center, [0.4, 1.2, 0.6]);
    assert_eq!((terms[0].amplitude.clone(), terms[0].phase.clone()), (vec![0.2; 3], vec![0.0; 3]));
    assert_eq!(terms[0].frequency, [0.1, 0.2, 0.3]);
    assert_eq!(fade_in.to_bits(), 1.0_f64.to_bits());
}

#[test]
fn words_choose_the_robots_values_or_none() {
    let torque = |text: &str| read(&with_line(19, text)).unwrap().control.torque_max;
    assert_eq!(torque("torque_max_nm = 'robot'"), Some(vec![50.0; 3]));
    assert_eq!(torque("torque_max_nm = 'none'"), None);
    assert_eq!(torque("torque_max_nm = 20"), Some(vec![20.0; 3]));
    let bits = |text: &str| read(&with_line(23, text)).unwrap().sensor.encoder_bits;
    assert_eq!(bits("encoder_bits = 'robot'"), Some(vec![18; 3]));
    assert_eq!(bits("encoder_bits = 'none'"), None);
    assert_eq!(bits("encoder_bits = [12, 13, 14]"), Some(vec![12, 13, 14]));
}

#[test]
fn the_law_may_be_stated_by_coefficients() {
    let text = with_line(13, "a = [4844.0, 139.2]").replace(
        "bandwidth_rad_s = 20.0\nestimator_bandwidth_rad_s = 70.0",
        "kp_per_s2 = 400\nkd_per_s = 40",
    );
    let law =
        LawRequest::Coefficients { kp: vec![400.0; 3], kd: vec![40.0; 3], a: vec![4844.0, 139.2] };
    assert_eq!(read(&text).unwrap().gains.unwrap().law, law);
}

#[test]
fn a_circle_has_a_normal_of_unit_length() {
    let text = with_reference(
        "[reference]\nkind = 'circle'\ncenter_m = [0.4, 0, 0.2]\nradius_m = 0.1\nperiod_s = 5\n\
         normal = [0, -3, 4]\nseed_rad = [0.4, 1.2, 0.6]\n",
    );
    let ReferenceRequest::Cartesian { frame, curve, seed, hold_orientation, .. } =
        read(&text).unwrap().reference
    else {
        panic!("cartesian")
    };
    assert_eq!((frame.as_str(), seed, hold_orientation), ("tool", vec![0.4, 1.2, 0.6], false));
    let Curve::Circle { normal, .. } = curve else { panic!("circle") };
    for (x, expected) in normal.into_iter().zip([0.0, -0.6, 0.8]) {
        assert!((x - expected).abs() < 1e-15);
    }
}

#[test]
fn locked_joints_are_gone_and_the_rest_keeps_its_order() {
    let text = with_line(6, "locked = { joint1 = 0.5 }")
        .replace("[0.42, 0.18, 0.14]", "{ joint3 = 0.3, joint2 = 0.2 }")
        .replace("frequency_hz = [0.1, 0.2, 0.3]", "frequency_hz = [0.2, 0.3]");
    let study = read(&text).unwrap();
    let names: Vec<&str> = study.robot.joints.iter().map(|joint| joint.name.as_str()).collect();
    assert_eq!(names, ["joint2", "joint3"]);
    assert_eq!(study.gains.unwrap().inertia, [0.2, 0.3]);
    assert_eq!(study.world.pushes[0].joint, 0);
    let ReferenceRequest::Sines { center, .. } = study.reference else { panic!("sines") };
    assert_eq!(center, [1.2, 0.6], "the named pose without the locked joint");
}

#[test]
fn a_study_may_state_the_rotors() {
    let text = with_line(6, "armature_kg_m2 = { joint3 = 0.0, joint1 = 0.4, joint2 = 0.3 }");
    let study = read(&text).unwrap();
    let rotors: Vec<f64> = study.robot.joints.iter().map(|joint| joint.armature).collect();
    assert_eq!(rotors, [0.4, 0.3, 0.0]);
    // On a stretched planar arm every inertia is that of the links plus the rotor's own.
    let inertia = |robot: &phihat_model::Robot| {
        let model = robot.plant_model();
        let mut matrix = [0.0; 9];
        model.mass_matrix(&mut phihat_model::Workspace::new(&model), &[0.0; 3], &mut matrix);
        [matrix[0], matrix[4], matrix[8]]
    };
    let (own, described) = (inertia(&study.robot), inertia(&read(GOOD).unwrap().robot));
    let grown: Vec<f64> = own.iter().zip(described).map(|(a, b)| a - b).collect();
    for (grown, wanted) in grown.into_iter().zip([0.3, 0.2, -0.1]) {
        assert!((grown - wanted).abs() < 1e-12, "{grown}");
    }
}

#[test]
fn a_run_may_start_off_the_reference() {
    let text = format!("{GOOD}[start]\nq_rad = [0.1, 0.2, 0.3]\ndq_rad_s = 0.5\n");
    let start = Start { q: vec![0.1, 0.2, 0.3], dq: vec![0.5; 3] };
    assert_eq!(read(&text).unwrap().world.start, Some(start));
    let text = format!("{GOOD}[start]\npose = 'zero'\n");
    assert_eq!(read(&text).unwrap().world.start, Some(Start { q: vec![0.0; 3], dq: vec![0.0; 3] }));
}

#[test]
fn sines_are_refused_only_where_they_leave_the_limits() {
    // Amplitudes add up to 3.6 around 0, beyond ±π; but the two terms cancel where they are large.
    let two = "fade_in_s = 0\n[[reference.sine]]\namplitude_rad = 1.8\nfrequency_hz = 0.1\n\
               [[reference.sine]]\namplitude_rad = 1.8\nfrequency_hz = 0.1\nphase_rad = PHASE\n";
    let head = "[reference]\nkind = 'sines'\ncenter_rad = 0\n";
    let read =
        |phase: &str| read(&with_reference(&format!("{head}{}", two.replace("PHASE", phase))));
    assert!(read("2.0").is_ok(), "largest sum 2·1.8·cos(1) = 1.95");
    let error = read("0.1").unwrap_err();
    assert!(error.to_string().contains("joint `joint1` reaches 3.14"), "{error}");
}

#[test]
fn a_byte_order_mark_and_carriage_returns_do_no_harm() {
    let text = format!("\u{feff}{}", GOOD.replace('\n', "\r\n"));
    assert_eq!(read(&text).unwrap().gains.unwrap().inertia, [0.42, 0.18, 0.14]);
    let error = read(&text.replace("rate_hz", "rate_khz")).unwrap_err();
    assert_eq!((error.line(), error.column()), (19, 1));
}

#[test]
fn the_fingerprint_is_that_of_the_text() {
    // Computed by another program (Python's hashlib) from the text of GOOD.
    let expected = "f4065daabf774be7ce42ceb145a32f590f025c018942cebb461f2111dc5834a6";
    assert_eq!(read(GOOD).unwrap().sha256, expected);
    assert_ne!(read(&format!("{GOOD}\n")).unwrap().sha256, expected);
}

#[test]
fn the_payload_set_holds_what_the_world_carries() {
    let set = read(GOOD).unwrap().design.payload;
    assert_eq!((set.frame.as_str(), set.mass, set.com), ("tool", (0.0, 0.3), [(0.0, 0.0); 3]));
    assert_eq!(set.corners(), [[0.0; 3]]);
    let payload = "payload = { mass_kg = 0.5, frame = 'link3', com_m = [0.1, -0.2, 0.0], \
                   inertia_kg_m2 = [6e-4, 0, 0, 6e-4, 0, 6e-4] }";
    let hull = read(&with_line(29, payload)).unwrap().design.payload;
    assert_eq!((hull.frame.as_str(), hull.mass), ("link3", (0.0, 0.5)));
    assert_eq!(hull.com, [(0.0, 0.1), (-0.2, 0.0), (0.0, 0.0)]);
    assert_eq!(hull.corners().len(), 4);
    assert!((hull.second_moment() - 3e-4).abs() < 1e-15, "{hull:?}");
    let typed = with_line(29, payload).replace(
        "[world]",
        "[design]\npayload_kg = [0.4, 1]\npayload_com_m = [[0, 0.1], [-0.3, 0.3], [0, 0.1]]\n\
         payload_gyration_m = 0.1\n[world]",
    );
    let typed = read(&typed).unwrap().design.payload;
    assert_eq!((typed.mass, typed.gyration, typed.corners().len()), ((0.4, 1.0), 0.1, 8));
    let none = read(&with_line(29, "")).unwrap().design.payload;
    assert_eq!((none.frame.as_str(), none.mass), ("tool", (0.0, 0.0)));
}

#[test]
fn dry_friction_is_known_to_an_interval_that_holds_the_worlds() {
    assert_eq!(read(GOOD).unwrap().design.coulomb, (vec![0.0; 3], vec![0.1 + 0.2; 3]));
    let typed = GOOD.replace(
        "[world]",
        "[design]\ncoulomb_min_nm = 0.05\ncoulomb_max_nm = {joint1=0.4,joint2=0.5,joint3=0.6}\n[world]",
    );
    let (low, high) = read(&typed).unwrap().design.coulomb;
    assert_eq!((low, high), (vec![0.05; 3], vec![0.4, 0.5, 0.6]));
    let none = GOOD.replace("[world]", "[world]\nfriction = 'none'");
    assert_eq!(read(&none).unwrap().design.coulomb, (vec![0.0; 3], vec![0.1; 3]));
}

#[test]
fn joints_without_a_description_have_no_tip() {
    let text = |spec: &str| {
        format!(
            "duration_s = 2.0\n[spec]\n{spec}[gains]\nbandwidth_rad_s = 10\nestimator_bandwidth_rad_s = 30\n\
             inertia_kg_m2 = 1\n[reference]\nkind = 'hold'\nq_rad = 0.1\n[[joint]]\nname = 'a'\ninertia_min_kg_m2 = 1\n\
             inertia_max_kg_m2 = 2\nphi_rate_max_nm_s = 1\nphi_jump_max_nm = 0.1\n"
        )
    };
    assert!(!read(&text("")).unwrap().has_tip());
    assert!(read(GOOD).unwrap().has_tip());
    let error = read(&text("tip_error_bound_mm = 1\n")).unwrap_err().to_string();
    let said = ["spec.tip_error_bound_mm", "where the tip is they do not tell", "error_bound_rad"];
    assert!(said.iter().all(|part| error.contains(part)), "{error}");
}

#[test]
fn springs_of_joints_are_stated_assumed_or_left_out() {
    let springs = |text: &str| read(&with_line(6, text)).map(|study| study.springs);
    assert_eq!(springs("armature_kg_m2 = 0.2").unwrap(), JointSprings::Unstated);
    let rigid = "transmission = { stiffness = \"rigid\" }";
    assert_eq!(springs(rigid).unwrap(), JointSprings::Rigid);
    let text = "armature_kg_m2 = 0.2\ntransmission = { stiffness_min_nm_rad = [1e4, 2e4, 3e4], \
                stiffness_max_nm_rad = 4e4, damping_min_nm_s_rad = 1.5 }";
    let stated = springs(text).unwrap();
    let stiffness = |springs: &JointSprings| {
        springs.stated().unwrap().iter().map(|spring| spring.stiffness).collect::<Vec<_>>()
    };
    assert_eq!(stiffness(&stated), [(1e4, 4e4), (2e4, 4e4), (3e4, 4e4)]);
    assert!(stated.stated().unwrap().iter().all(|spring| spring.damping == (1.5, 1.5)));
    // The planar arm's description states none: those of large joints, at 1 to 5 % of critical damping.
    let robot = springs("armature_kg_m2 = 0.25\ntransmission = { stiffness = \"robot\" }").unwrap();
    assert_eq!(stiffness(&robot), [(1e4, 3e4); 3]);
    let near = |a: f64, b: f64| (a - b).abs() < 1e-12;
    let mut all = robot.stated().unwrap().iter();
    assert!(all.all(|spring| near(spring.damping.0, 1.0) && near(spring.damping.1, 5.0)));
    let rotorless = text.replace("armature_kg_m2 = 0.2", "armature_kg_m2 = 0.0");
    let told = springs(&rotorless).unwrap_err().to_string();
    assert!(told.contains("no rotor inertia to stand behind a spring"), "{told}");
}
