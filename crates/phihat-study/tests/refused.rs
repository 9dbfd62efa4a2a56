//! Every mistake is one error, on the right line, with what would be right.
//!
//! Wrong if a bad study is read, or if a message sends its reader to another line or key.

use std::fs;
use std::path::Path;

use crate::support::{GOOD, REFERENCE_LINE, read, read_in, with_line, with_reference};
use phihat_study::StudyErrorKind::{
    BeyondLimits, Conflict, MissingKey, OutOfRange, Robot, Syntax, UnknownKey, UnknownName,
    WrongLength, WrongType, WrongUnit,
};
use phihat_study::{StudyError, StudyErrorKind};

fn check(text: &str, (line, key, kind, fragment): (usize, &str, StudyErrorKind, &str)) {
    let answer: Result<(), StudyError> = read(text).map(drop);
    assert!(answer.is_err(), "read, but {kind:?} is at line {line}, {key}: {fragment}");
    let error = answer.unwrap_err();
    let shown = error.to_string();
    assert_eq!(error.line(), line, "line of: {shown}");
    assert_eq!(error.key(), key, "key of: {shown}");
    assert_eq!(error.kind(), kind, "kind of: {shown}");
    assert!(shown.contains(fragment), "`{fragment}` is not in: {shown}");
    assert!(!shown.contains('\n'), "more than one line: {shown}");
    assert_eq!(error.file(), "studies/base.toml");
    assert!(text.is_char_boundary(error.span().start) && error.span().end <= text.len());
    let on_line = text[..error.span().start].matches('\n').count() + 1;
    assert_eq!(on_line, line, "span of: {shown}");
    assert!(error.render().contains(error.message()));
}

/// Line of the good study, what stands there instead, and the error expected on that line.
type Case = (usize, &'static str, &'static str, StudyErrorKind, &'static str);

const TOP: &[Case] = &[
    (1, "titel = 'x'", "titel", UnknownKey, "did you mean `title`?"),
    (1, "title = 3", "title", WrongType, "expected a string, found an integer"),
    (1, "title = ' '", "title", OutOfRange, "must not be empty"),
    (1, "title = \"a\\nb\"", "title", OutOfRange, "one line"),
    (1, "rate_hz = 100.0", "rate_hz", UnknownKey, "`rate_hz` belongs in [loop]"),
    (2, "duration_s = 0", "duration_s", OutOfRange, "0 is out of range: above 0"),
    (2, "duration_s = -5.0", "duration_s", OutOfRange, "-5 is out of range"),
    (2, "duration_s = nan", "duration_s", OutOfRange, "NaN is not a finite number"),
    (2, "duration_s = inf", "duration_s", OutOfRange, "not a finite number"),
    (2, "duration_s = '5'", "duration_s", WrongType, "expected a number, found a string"),
    (2, "duration_s = 80000.0", "duration_s", OutOfRange, "80000000 control samples"),
    (2, "duration_s = 1e-4", "duration_s", OutOfRange, "control samples"),
    (2, "duration_ms = 5000.0", "duration_ms", WrongUnit, "unit here is s; write `duration_s`"),
    (2, "duration = 5.0", "duration", WrongUnit, "write `duration_s`"),
    (2, "duration_s = 5.0 5.0", "", Syntax, "not TOML"),
    (3, "seed = -1", "seed", OutOfRange, "-1 is out of range"),
    (3, "seed = 1.5", "seed", WrongType, "expected an integer, found a number with a fraction"),
    (3, "seed = 99999999999999999999", "seed", WrongType, "does not fit 64 bits"),
    (3, "duration_s = 6.0", "", Syntax, "duplicate key `duration_s`"),
    (3, "seed = 1979-05-27", "seed", WrongType, "found a date"),
    (3, "\u{7f}", "", Syntax, "not TOML"),
];

const ROBOT: &[Case] = &[
    (5, "name = 'planar3R'", "robot.name", UnknownName, "did you mean `planar3r`?"),
    (5, "name = 'atlas'", "robot.name", UnknownName, "`panda`"),
    (5, "nme = 'panda'", "robot.nme", UnknownKey, "did you mean `name`?"),
    (5, "file = 'nowhere.toml'", "robot.file", Robot, "nowhere.toml"),
    (6, "file = 'arm.urdf'", "robot.file", Conflict, "both `name` and `file`"),
    (6, "locked = { joint4 = 0.0 }", "robot.locked.joint4", UnknownName, "did you mean `joint1`?"),
    (6, "locked = { joint1 = 3.5 }", "robot.locked.joint1", BeyondLimits, "outside its limits"),
    (6, "locked = 'joint1'", "robot.locked", WrongType, "expected a table by joint name"),
    (6, "locked = {joint1=0,joint2=0,joint3=0}", "robot.locked", Conflict, "every joint"),
    (6, "armature_kg_m2 = -0.1", "robot.armature_kg_m2", OutOfRange, "0 to 10000"),
    (
        6,
        "armature_kg_m2 = [0.1, 0.1]",
        "robot.armature_kg_m2",
        WrongLength,
        "2 entries for 3 joints",
    ),
    (6, "armature_kg_cm2 = 0.1", "robot.armature_kg_cm2", WrongUnit, "write `armature_kg_m2`"),
    (
        6,
        "transmission = { stiffness_min_nm_rad = 1e4 }",
        "robot.transmission.damping_min_nm_s_rad",
        MissingKey,
        "damping_min_nm_s_rad",
    ),
    (
        6,
        "transmission = { stiffness = \"rigid\", damping_min_nm_s_rad = 1.0 }",
        "robot.transmission.damping_min_nm_s_rad",
        Conflict,
        "leave it out",
    ),
    (
        6,
        "transmission = { stiffness_min_nm_rad = 0.0, damping_min_nm_s_rad = 1.0 }",
        "robot.transmission.stiffness_min_nm_rad",
        OutOfRange,
        "above 0",
    ),
    (
        6,
        "transmission = { stiffness_min_nm_rad = 2e4, stiffness_max_nm_rad = 1e4, damping_min_nm_s_rad = 1.0 }",
        "robot.transmission.stiffness_min_nm_rad",
        Conflict,
        "20000 is above stiffness_max_nm_rad = 10000",
    ),
    (
        6,
        "transmission = { stiffness_min_nm_rad = 1e4, damping_min_nm_s_rad = [1.0, 1.0] }",
        "robot.transmission.damping_min_nm_s_rad",
        WrongLength,
        "2 entries for 3 joints",
    ),
];

const SPEC_AND_GAINS: &[Case] = &[
    (9, "settle_s = 5.0", "spec.settle_s", Conflict, "not before the end of the run at 5 s"),
    (9, "settle_s = -1.0", "spec.settle_s", OutOfRange, "0 to 86400"),
    (10, "error_bound_deg = 0.1", "spec.error_bound_deg", WrongUnit, "write `error_bound_rad`"),
    (
        10,
        "eror_bound_rad = 0.1",
        "spec.eror_bound_rad",
        UnknownKey,
        "did you mean `error_bound_rad`?",
    ),
    (10, "error_bound_rad = 0.0", "spec.error_bound_rad", OutOfRange, "above 0"),
    (
        10,
        "error_bound_rad = [1e-3, 1e-3]",
        "spec.error_bound_rad",
        WrongLength,
        "2 entries for 3 joints",
    ),
    (10, "error_bound_rad = [1e-3, -1e-3, 1e-3]", "spec.error_bound_rad[1]", OutOfRange, "-0.001"),
    (
        10,
        "error_bound_rad = 'small'",
        "spec.error_bound_rad",
        WrongType,
        "an array with one per joint",
    ),
    (
        10,
        "velocity_error_bound_rad = 0.1",
        "spec.velocity_error_bound_rad",
        WrongUnit,
        "the unit here is rad/s",
    ),
    (13, "order = 5", "gains.order", OutOfRange, "5 is out of range: 1 to 4"),
    (13, "order = [1, 2, 0]", "gains.order[2]", OutOfRange, "0 is out of range: 1 to 4"),
    (13, "order = 2.0", "gains.order", WrongType, "expected an integer"),
    (
        13,
        "kp_per_s2 = 400.0",
        "gains.bandwidth_rad_s",
        Conflict,
        "cannot be mixed with `kp_per_s2`",
    ),
    (13, "a = []", "gains.a", WrongLength, "0 numbers, expected 1 to 4"),
    (14, "bandwidth_hz = 3.0", "gains.bandwidth_hz", WrongUnit, "write `bandwidth_rad_s`"),
    (14, "bandwidth_rad_s = 3200.0", "gains.bandwidth_rad_s", OutOfRange, "below π·rate = 3142"),
    (
        14,
        "bandwidth_rad_s = {joint1=1,joint2=1e4,joint3=1}",
        "gains.bandwidth_rad_s.joint2",
        OutOfRange,
        "10000",
    ),
    (14, "kd_per_s = 40.0", "gains.estimator_bandwidth_rad_s", Conflict, "mixed with `kd_per_s`"),
    (16, "inertia_kg_m2 = -0.4", "gains.inertia_kg_m2", OutOfRange, "-0.4"),
    (
        16,
        "inertia_kg_m2 = {joint1=1.0,joint2=1.0}",
        "gains.inertia_kg_m2",
        WrongLength,
        "no value for joint `joint3`",
    ),
    (
        16,
        "inertia_kg_m2 = {joint1=1,joint2=1,joint3=1,jiont2=1}",
        "gains.inertia_kg_m2.jiont2",
        UnknownName,
        "did you mean `joint2`?",
    ),
    (16, "inertia_kg_m2 = {joint1=1,joint2=1,joint2=1}", "", Syntax, "duplicate key `joint2`"),
    (
        16,
        "inertia_kg_m2 = [0.4, '0.2', 0.1]",
        "gains.inertia_kg_m2[1]",
        WrongType,
        "found a string",
    ),
    (16, "inertia_g_m2 = 1.0", "gains.inertia_g_m2", WrongUnit, "write `inertia_kg_m2`"),
];

const LOOP_AND_SENSOR: &[Case] = &[
    (
        19,
        "rate_khz = 1.0",
        "loop.rate_khz",
        WrongUnit,
        "unknown key: the unit here is Hz; write `rate_hz`",
    ),
    (19, "rate_hz = 0.5", "loop.rate_hz", OutOfRange, "1 to 20000"),
    (19, "rate_hz = 1e5", "loop.rate_hz", OutOfRange, "1 to 20000"),
    (19, "torque_max_mnm = 1.0", "loop.torque_max_mnm", WrongUnit, "write `torque_max_nm`"),
    (19, "torque_max_nm = 'nnoe'", "loop.torque_max_nm", UnknownName, "did you mean `none`?"),
    (19, "torque_max_nm = 0", "loop.torque_max_nm", OutOfRange, "above 0"),
    (
        19,
        "torque_rate_max_nm_s = 'robot'",
        "loop.torque_rate_max_nm_s",
        Robot,
        "states no value for joint `joint1`",
    ),
    (19, "form = 'literl'", "loop.form", UnknownName, "did you mean `literal`?"),
    (20, "delay_samples = 9", "loop.delay_samples", OutOfRange, "9 is out of range: 0 to 8"),
    (
        20,
        "torque_filter_hz = 600.0",
        "loop.torque_filter_hz",
        OutOfRange,
        "half of the loop's rate",
    ),
    (20, "torque_filter_hz = 0.0", "loop.torque_filter_hz", OutOfRange, "above 0"),
    (20, "energy_max_j = 0", "loop.energy_max_j", OutOfRange, "0 is out of range: above 0"),
    (20, "energy_window_s = 0.1", "loop.energy_window_s", Conflict, "energy_max_j, which is not"),
    (20, "delay_ms = 1", "loop.delay_ms", WrongUnit, "write `delay_samples`"),
    (23, "encoder_bits = 0", "sensor.encoder_bits", OutOfRange, "1 to 32"),
    (23, "encoder_bits = [18, 33, 18]", "sensor.encoder_bits[1]", OutOfRange, "1 to 32"),
    (
        23,
        "position_noise_max_lsb = 1.0",
        "sensor.position_noise_max_lsb",
        Conflict,
        "quanta of an encoder",
    ),
    (24, "sample_stamps = 'exact'", "sensor.sample_stamps", UnknownName, "nominal"),
    (24, "velocity = 'difference'", "sensor.velocity", UnknownName, "did you mean `differenced`?"),
    (
        24,
        "velocity_filter_hz = 600.0",
        "sensor.velocity_filter_hz",
        OutOfRange,
        "half of the loop's rate",
    ),
];

const WORLD: &[Case] = &[
    (
        29,
        "network = { commands_lost_max = 3 }",
        "world.network.commands_lost_max",
        Conflict,
        "how often is not stated",
    ),
    (
        29,
        "network = { commands_lost_every_s = 0.5 }",
        "world.network.commands_lost_every_s",
        Conflict,
        "how many are lost is not stated",
    ),
    (
        29,
        "network = { commands_lost_max = 21, commands_lost_every_s = 0.5 }",
        "world.network.commands_lost_max",
        OutOfRange,
        "0 to 20",
    ),
    (27, "gravity_m_s2 = [0.0, -9.81]", "world.gravity_m_s2", WrongLength, "2 numbers, expected 3"),
    (27, "gravity_m_s2 = 9.81", "world.gravity_m_s2", WrongType, "an array of numbers"),
    (27, "friction = true", "world.friction", WrongType, "expected a string, found a boolean"),
    (
        28,
        "coulomb_extra_nm = [0.1, nan, 0.1]",
        "world.coulomb_extra_nm[1]",
        OutOfRange,
        "not a finite",
    ),
    (28, "substeps = 0", "world.substeps", OutOfRange, "1 to 1000"),
    (28, "drive_bandwidth_hz = 'robot'", "world.drive_bandwidth_hz", Robot, "states no value"),
    (29, "payload = { mass_kg = -0.5 }", "world.payload.mass_kg", OutOfRange, "-0.5"),
    (
        29,
        "payload = { mas_kg = 0.5 }",
        "world.payload.mas_kg",
        UnknownKey,
        "did you mean `mass_kg`?",
    ),
    (29, "payload = { mass_g = 500 }", "world.payload.mass_g", WrongUnit, "write `mass_kg`"),
    (29, "payload = {}", "world.payload.mass_kg", MissingKey, "missing key"),
    (
        29,
        "payload = { mass_kg = 1, frame = 'tol' }",
        "world.payload.frame",
        UnknownName,
        "did you mean `tool`?",
    ),
    (
        29,
        "payload = { mass_kg = 1, inertia_kg_m2 = [1, 0, 0, 1, 0, 3] }",
        "world.payload.inertia_kg_m2",
        OutOfRange,
        "no rigid body",
    ),
    (31, "[world.push]", "world.push", WrongType, "expected an array of tables"),
    (32, "joint = 'joint22'", "world.push[0].joint", UnknownName, "did you mean `joint2`?"),
    (33, "torque_nm = 'big'", "world.push[0].torque_nm", WrongType, "expected a number"),
    (34, "start_s = 5.0", "world.push[0].start_s", Conflict, "not before the end of the run"),
    (35, "duration_s = 0.0", "world.push[0].duration_s", OutOfRange, "above 0"),
];

/// Mistakes in a `[design]` at line 26 of the good study, before `[world]`, whose payload is 0.3 kg at the
/// tip and whose dry friction is 0.2 N·m + 0.1 N·m.
const DESIGN: &[Case] = &[
    (27, "payload_kg = [0.1, 0.2]", "design.payload_kg", Conflict, "valid: at least 0.3 kg"),
    (27, "payload_kg = [0.4, 0.5]", "design.payload_kg", Conflict, "valid: at most 0.3 kg"),
    (27, "payload_kg = [0.5, 0.4]", "design.payload_kg", Conflict, "the lighter one comes first"),
    (27, "payload_kg = 0.5", "design.payload_kg", WrongType, "an array of numbers"),
    (27, "payload_kg = [0, -1]", "design.payload_kg[1]", OutOfRange, "0 to 10000"),
    (27, "payload_max_kg = 0.2", "design.payload_max_kg", Conflict, "world.payload has 0.3 kg"),
    (
        27,
        "payload_max_kg = 1\npayload_kg = [0, 1]",
        "design.payload_kg",
        Conflict,
        "keep one of them",
    ),
    (
        27,
        "payload_com_m = [[0, 0.1], [0.01, 0.02], [0, 0]]",
        "design.payload_com_m",
        Conflict,
        "an interval for y that holds 0 m",
    ),
    (
        27,
        "payload_com_m = [[0, 0.1], [0.02, 0.01], [0, 0]]",
        "design.payload_com_m[1]",
        OutOfRange,
        "low end comes first",
    ),
    (27, "payload_com_m = [[0, 1]]", "design.payload_com_m", WrongLength, "expected 3"),
    (
        27,
        "payload_com_m = [[0, 1], [0], [0, 0]]",
        "design.payload_com_m[1]",
        WrongLength,
        "expected 2",
    ),
    (27, "payload_frame = 'tol'", "design.payload_frame", UnknownName, "did you mean `tool`?"),
    (27, "payload_frame = 'link1'", "design.payload_frame", Conflict, "welded to `tool`"),
    (27, "payload_gyration_mm = 1", "design.payload_gyration_mm", WrongUnit, "payload_gyration_m"),
    (27, "coulomb_min_nm = 0.4", "design.coulomb_min_nm", Conflict, "valid: at most 0.3"),
    (
        27,
        "coulomb_max_nm = [0.4, 0.25, 0.4]",
        "design.coulomb_max_nm[1]",
        Conflict,
        "valid: at least 0.3",
    ),
];

#[test]
fn mistakes_in_what_the_design_is_told_of_payload_and_friction() {
    for &(line, text, key, kind, fragment) in DESIGN {
        let whole = with_line(25, &format!("[design]\n{text}"));
        let extra = text.matches('\n').count();
        let whole = whole.replace("\n[world]", "\n\n[world]");
        check(&whole, (line - 1 + extra, key, kind, fragment));
    }
}

#[test]
fn a_payload_is_where_a_joint_moves_it_and_inside_its_set() {
    let on_base = |line: &str| {
        with_line(29, line).replace("[world]", "[design]\npayload_max_kg = 1.0\n[world]")
    };
    let base = "payload = { mass_kg = 1, frame = 'base' }";
    check(&with_line(29, base), (29, "world.payload.frame", Conflict, "valid: link1, link2"));
    let design = on_base("").replace("payload_max", "payload_frame = 'base'\npayload_max");
    check(&design, (27, "design.payload_frame", Conflict, "valid: link1, link2"));
    let later = "payload = { mass_kg = 1, start_s = 1 }";
    let text = with_line(29, later).replace("[world]", "[design]\npayload_kg = [0.5, 2]\n[world]");
    check(&text, (27, "design.payload_kg", Conflict, "0 kg at some time"));
    let cube = "payload = { mass_kg = 1, inertia_kg_m2 = [6e-4, 0, 0, 6e-4, 0, 6e-4] }";
    let text =
        with_line(29, cube).replace("[world]", "[design]\npayload_gyration_m = 0.01\n[world]");
    check(&text, (27, "design.payload_gyration_m", Conflict, "at least 0.017321 m"));
}

const REFERENCE: &[Case] = &[
    (38, "kind = 'sinus'", "reference.kind", UnknownName, "did you mean `sines`?"),
    (38, "kind = 3", "reference.kind", WrongType, "expected a string"),
    (39, "center = 'redy'", "reference.center", UnknownName, "did you mean `ready`?"),
    (39, "center_deg = [0, 45, 0]", "reference.center_deg", WrongUnit, "write `center_rad`"),
    (
        39,
        "center_rad = [0.0, 45.0, 0.0]",
        "reference.center_rad[1]",
        BeyondLimits,
        "45 deg = 0.7854 rad",
    ),
    (
        39,
        "center_rad = 3.2",
        "reference.center_rad",
        BeyondLimits,
        "joint `joint1`: 3.2 is outside",
    ),
    (40, "center_rad = 0.0", "reference.center_rad", Conflict, "both"),
    (40, "radius_m = 0.1", "reference.radius_m", UnknownKey, "belongs to kind = \"circle\""),
    (40, "fade_in_ms = 100", "reference.fade_in_ms", WrongUnit, "write `fade_in_s`"),
    (
        43,
        "amplitude_rad = [0.2, 2.5, 0.2]",
        "reference.sine[0].amplitude_rad[1]",
        BeyondLimits,
        "joint `joint2` reaches 3.",
    ),
    (44, "frequency_hz = 500.0", "reference.sine[0].frequency_hz", OutOfRange, "not below half"),
    (44, "frequency_hz = -1.0", "reference.sine[0].frequency_hz", OutOfRange, "-1"),
    (44, "phase_rad = 0.0", "reference.sine[0].frequency_hz", MissingKey, "missing key; Frequency"),
];

fn check_all(cases: &[Case]) {
    for &(line, text, key, kind, fragment) in cases {
        // A conflict is reported at the later of two lines, a missing key at its section's head.
        let expected = match (kind, key) {
            (Conflict, "gains.bandwidth_rad_s") => 14,
            (Conflict, "gains.estimator_bandwidth_rad_s") => 15,
            (MissingKey, "reference.sine[0].frequency_hz") => 42,
            _ => line,
        };
        check(&with_line(line, text), (expected, key, kind, fragment));
    }
}

#[test]
fn mistakes_at_the_top_and_in_the_robot() {
    check_all(TOP);
    check_all(ROBOT);
}

#[test]
fn mistakes_in_spec_and_gains() {
    check_all(SPEC_AND_GAINS);
}

#[test]
fn mistakes_in_loop_and_sensor() {
    check_all(LOOP_AND_SENSOR);
}

#[test]
fn mistakes_in_the_world() {
    check_all(WORLD);
}

#[test]
fn mistakes_in_sines() {
    check_all(REFERENCE);
}

#[test]
fn missing_keys_are_reported_at_their_section() {
    for (line, at, key, help) in [
        (2, 1, "duration_s", "Simulated time"),
        (5, 4, "robot.name", "give `name` or `file`"),
        (14, 12, "gains.bandwidth_rad_s", "ω of the outer loop"),
        (16, 12, "gains.inertia_kg_m2", "[kg·m²]"),
        (32, 31, "world.push[0].joint", "Joint name"),
        (38, 37, "reference.kind", "`waypoints`"),
        (39, 37, "reference.center_rad", "give `center_rad` or `center`"),
        (43, 42, "reference.sine[0].amplitude_rad", "Amplitude"),
    ] {
        check(&with_line(line, ""), (at, key, MissingKey, help));
    }
    let no_gains = with_line(12, "[spec.gains]");
    check(&no_gains, (12, "spec.gains", UnknownKey, "`gains` belongs to the top of the file"));
    check("duration_s = 1.0\n", (1, "reference", MissingKey, "missing section [reference]"));
    let no_arm = "duration_s = 1.0\n[reference]\nkind = 'hold'\nq_rad = 0.0\n";
    check(no_arm, (1, "robot", MissingKey, "missing section [robot]"));
    check("", (1, "duration_s", MissingKey, "missing key"));
}

/// Text of `[reference]`, and the error expected so many lines below it.
type ReferenceCase = (&'static str, usize, &'static str, StudyErrorKind, &'static str);

const OTHER_KINDS: &[ReferenceCase] = &[
    ("[reference]\nkind = 'hold'\n", 0, "reference.q_rad", MissingKey, "give `q_rad` or `pose`"),
    (
        "[reference]\nkind = 'hold'\nq_rad = [4.0, 0.0, 0.0]\n",
        2,
        "reference.q_rad[0]",
        BeyondLimits,
        "-3.14",
    ),
    ("[reference]\nkind = 'hold'\nq_deg = 4.0\n", 2, "reference.q_deg", WrongUnit, "write `q_rad`"),
    (
        "[reference]\nkind = 'waypoints'\n",
        0,
        "reference.waypoint",
        MissingKey,
        "[[reference.waypoint]]",
    ),
    (
        "[reference]\nkind = 'waypoints'\n[[reference.waypoint]]\nt_s = 1.0\npose = 'ready'\n",
        3,
        "reference.waypoint[0].t_s",
        OutOfRange,
        "expected 0",
    ),
    (
        "[reference]\nkind = 'waypoints'\nwaypoint = \
            [\n{t_s=0,pose='ready'},\n{t_s=2,q_rad=0.1},\n{t_s=2.0,pose='ready'}]\n",
        5,
        "reference.waypoint[2].t_s",
        OutOfRange,
        "2 s is not after",
    ),
    (
        "[reference]\nkind = 'waypoints'\nwaypoint = [\n{t_s=0,q_rad=0},\n{t_s=0.1,q_rad=[0.0,1.0,0.0]}]\n",
        4,
        "reference.waypoint[1].q_rad[1]",
        BeyondLimits,
        "joint `joint2`: 18.75",
    ),
    (
        "[reference]\nkind = 'waypoints'\nwaypoint = [\n{t_s=0,q_rad=0},\n{t_s=2,q_rad=[0,1,4]}]\n",
        4,
        "reference.waypoint[1].q_rad[2]",
        BeyondLimits,
        "joint `joint3`: 4 is outside",
    ),
    (
        "[reference]\nkind = 'circle'\ncenter_m = [0.4, 0, 0]\nradius_m = 0.0\nperiod_s = 5\nseed = 'ready'\n",
        3,
        "reference.radius_m",
        OutOfRange,
        "above 0",
    ),
    (
        "[reference]\nkind = 'circle'\ncenter_mm = [400, 0, 0]\nradius_m = 0.1\nperiod_s = 5\nseed = 'ready'\n",
        2,
        "reference.center_mm",
        WrongUnit,
        "write `center_m`",
    ),
    (
        "[reference]\nkind = 'circle'\ncenter_m = [0.4, 0, 0]\nradius_m = 0.1\nnormal = [0, 0, 0]\nperiod_s = 5\nseed \
            = 'ready'\n",
        4,
        "reference.normal",
        OutOfRange,
        "no direction",
    ),
    (
        "[reference]\nkind = 'circle'\ncenter_m = [0.4, 0, 0]\nradius_m = 0.1\nperiod_s = 5\nhold_orientation = \
            true\nseed = 'ready'\n",
        5,
        "reference.hold_orientation",
        Conflict,
        "needs 6 joints, the robot has 3",
    ),
    (
        "[reference]\nkind = 'circle'\nframe = 'link4'\ncenter_m = [0.4, 0, 0]\nradius_m = 0.1\nperiod_s = 5\nseed = \
            'ready'\n",
        2,
        "reference.frame",
        UnknownName,
        "did you mean `link",
    ),
    (
        "[reference]\nkind = 'curve'\nperiod_s = 5\nseed = 'ready'\npoints_m = [[0,0,0],[1,0,0],[1,0,1]]\n",
        4,
        "reference.points_m",
        WrongLength,
        "3 points, expected 4 to",
    ),
    (
        "[reference]\nkind = 'curve'\nperiod_s = 5\nseed = 'ready'\npoints_m = [[0,0,0],[1,0,0],\n[1,0],[0,0,1]]\n",
        5,
        "reference.points_m[2]",
        WrongLength,
        "2 numbers, expected 3",
    ),
    (
        "[reference]\nkind = 'curve'\nperiod_s = 5\nseed = 'ready'\npoints_m = \
            [[0,0,0],[1,0,0],[1,0,1],\n[0,0,1],[0,0,0]]\n",
        5,
        "reference.points_m[4]",
        Conflict,
        "closes by itself",
    ),
    (
        "[reference]\nkind = 'curve'\nperiod_s = 5\nseed = 'ready'\npoints_m = \
            [[0,0,0],[1,0,0],\n[1,0,0],[0,0,1],[0,1,0]]\n",
        5,
        "reference.points_m[2]",
        Conflict,
        "repeats",
    ),
    (
        "[reference]\nkind = 'csv'\nfile = 'nowhere.csv'\n",
        2,
        "reference.file",
        StudyErrorKind::Unreadable,
        "`nowhere.csv`",
    ),
    (
        "[reference]\nkind = 'csv'\nfile = '.'\n",
        2,
        "reference.file",
        StudyErrorKind::Unreadable,
        "`.`",
    ),
    (
        "[start]\nq_rad = 0.1\npose = 'ready'\n[reference]\nkind = 'hold'\npose = 'ready'\n",
        2,
        "start.pose",
        Conflict,
        "both",
    ),
    (
        "[start]\npose = 'ready'\ndq_rad_s = [0, 11, 0]\n[reference]\nkind = 'hold'\npose = 'ready'\n",
        2,
        "start.dq_rad_s[1]",
        BeyondLimits,
        "11.0000 rad/s is beyond its limit 10",
    ),
    ("reference = 3\n", 0, "world.push[0].reference", UnknownKey, "top of the file"),
    (
        "[[reference]]\nkind = 'hold'\n",
        0,
        "reference",
        WrongType,
        "expected a table, found an array",
    ),
];

#[test]
fn mistakes_in_the_other_kinds_of_reference() {
    for &(text, below, key, kind, fragment) in OTHER_KINDS {
        check(&with_reference(text), (REFERENCE_LINE + below, key, kind, fragment));
    }
}

#[test]
fn a_locked_joint_is_no_joint_any_more() {
    let locked = with_line(6, "locked = { joint2 = 0.5 }");
    check(&locked, (16, "gains.inertia_kg_m2", WrongLength, "3 entries for 2 joints"));
    let by_name = locked.replace("[0.42, 0.18, 0.14]", "{joint1=1,joint2=1,joint3=1}");
    check(&by_name, (16, "gains.inertia_kg_m2.joint2", UnknownName, "joint `joint2` is locked"));
    let scalar = locked.replace("[0.42, 0.18, 0.14]", "1.0");
    check(&scalar, (32, "world.push[0].joint", UnknownName, "joint `joint2` is locked"));
}

#[test]
fn an_arm_is_cut_out_of_a_file_by_its_base_and_tip() {
    let robots = Path::new(env!("CARGO_MANIFEST_DIR")).join("../phihat-model/robots");
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(env!("CARGO_PKG_NAME")).join("cut");
    fs::create_dir_all(&folder).unwrap();
    // By itself: what stands beside the file is about the whole arm.
    fs::copy(robots.join("planar3r.urdf"), folder.join("alone.urdf")).unwrap();
    let with = |keys: &str| {
        let text = GOOD.replace("name = \"planar3r\"\nlocked = {}", keys);
        let text = text.replace("[0.42, 0.18, 0.14]", "[0.42, 0.18]");
        let text = text.replace("[0.1, 0.2, 0.3]", "[0.1, 0.2]");
        read_in(&text.replace("center = \"ready\"", "center_rad = [0.4, 0.5]"), &folder)
    };
    let robot = phihat_model::Robot::named("planar3r").unwrap();
    let [base, .., tip] = robot.model.frame_names() else { panic!("frames") };
    let cut =
        format!("file = 'alone.urdf'\nbase = {base:?}\ntip = {tip:?}\nlocked = {{ joint3 = 0.2 }}");
    let study = with(&cut).unwrap();
    assert_eq!(study.robot.model.joint_names(), ["joint1", "joint2"]);
    assert_eq!(study.robot.tip, *tip);
    let error = with(&cut.replace(&format!("{tip:?}"), "'nothing'")).unwrap_err().to_string();
    assert!(error.contains("there is no link \"nothing\""), "{error}");
    let built_in = with_line(6, "base = \"base\"");
    check(&built_in, (6, "robot.base", Conflict, "arms already"));
}

#[test]
fn the_first_mistake_of_several_is_the_one() {
    let text =
        with_line(19, "rate_khz = 1.0").replace("mass_kg", "mass_g").replace("18\n", "'x'\n");
    check(&text, (19, "loop.rate_khz", WrongUnit, "Hz"));
}

#[test]
fn a_name_that_no_study_can_have_is_refused() {
    for origin in
        ["", "Base.toml", "a b.toml", "../.toml", "ä.toml", &format!("{}.toml", "a".repeat(65))]
    {
        let error = phihat_study::Study::from_text(GOOD, origin, "".as_ref()).unwrap_err();
        assert_eq!((error.kind(), error.line()), (UnknownName, 0), "{origin}");
    }
}

#[test]
fn the_rendering_marks_the_place() {
    let error = read(&with_line(19, "rate_khz = 1.0")).unwrap_err();
    let expected = "error: loop.rate_khz: unknown key: the unit here is Hz
   --> studies/base.toml:19:1
   |
19 | rate_khz = 1.0
   | ^^^^^^^^
   = help: write `rate_hz`";
    assert_eq!(error.render(), expected);
}

#[test]
fn the_rendering_is_safe_for_terminals_and_short() {
    let hostile = format!("title = \"\u{9b}31m{}\"", "x".repeat(5000));
    let error = read(&with_line(1, &hostile)).unwrap_err();
    assert!(error.render().chars().all(|c| !c.is_control() || c == '\n'));
    assert!(error.render().lines().all(|line| line.chars().count() <= 120), "{}", error.render());
}

#[test]
fn a_time_that_no_law_from_positions_is_designed_for_is_refused() {
    let designed = |form: &str, key: &str| {
        let lines: Vec<&str> = GOOD.lines().collect();
        let (before, after) = (&lines[..11], &lines[16..]);
        let (before, after) = (before.join("\n"), after.join("\n"));
        format!("{before}\n[design]\n{key} = 0.2\n{after}\n")
            .replace("[loop]", &format!("[loop]\nform = \"{form}\""))
    };
    for key in ["settling_time_s", "rise_time_s"] {
        let named = format!("design.{key}");
        check(
            &designed("positions", key),
            (13, &named, Conflict, "a law from positions is not designed for it"),
        );
        read(&designed("observer", key)).unwrap();
        read(&designed("design", key)).unwrap();
    }
}

#[test]
fn a_filter_on_an_innovation_that_a_law_does_not_have_is_refused() {
    let designed = |form: &str, filter: bool| {
        let lines: Vec<&str> = GOOD.lines().collect();
        let (before, after) = (lines[..11].join("\n"), lines[16..].join("\n"));
        format!("{before}\n[design]\ninnovation_filter = {filter}\n{after}\n")
            .replace("[loop]", &format!("[loop]\nform = \"{form}\""))
    };
    let named = "design.innovation_filter";
    for form in ["observer", "literal"] {
        let why = "only a law from positions has an innovation to filter";
        check(&designed(form, true), (13, named, Conflict, why));
        assert!(read(&designed(form, false)).is_ok());
    }
    for form in ["positions", "design"] {
        assert!(read(&designed(form, true)).unwrap().design.innovation_filter);
    }
}

#[test]
fn mistakes_in_the_papers_recipe() {
    // Beside gains that are stated, nothing is searched.
    let stated = GOOD.split_once("[gains]").unwrap();
    let sought = [stated.0, stated.1.split_once("[loop]").unwrap().1].join("[loop]");
    let beside = read(&format!("{GOOD}\n[design.paper]\nphi_max = 2.0\n")).unwrap_err();
    assert_eq!(beside.key(), "design.paper", "{beside}");
    for (text, key, fragment) in [
        ("feedback = true\nminimum_by = \"40\"", "design.paper.feedback", "keep one of them"),
        ("minimum_by = 40", "design.paper.minimum_by", "expected a string"),
        ("minimum_by = \"41\"", "design.paper.minimum_by", "is not known here"),
        ("phi_max = [1.0, 2.0]", "design.paper.phi_max", "3"),
        ("per_joint = 1", "design.paper.per_joint", "true or false"),
    ] {
        let error = read(&format!("{sought}\n[design.paper]\n{text}\n")).unwrap_err();
        assert_eq!(error.key(), key, "{error}");
        assert!(error.render().contains(fragment), "{text}: {}", error.render());
    }
    let study = read(&format!("{sought}\n[design.paper]\nphi_max = 2.0\n")).unwrap();
    let paper = &study.design.paper;
    assert_eq!(paper.phi_max.as_deref(), Some(&[2.0; 3][..]));
    assert!(!paper.per_joint && !paper.by_40);
}

#[test]
fn what_follows_a_contact_is_refused_with_its_reason() {
    let with = |then: &str| {
        let text = format!("{GOOD}\n[contact]\nthen = \"{then}\"\n");
        let line = text.lines().count();
        (text, line)
    };
    for (then, kind, why) in [
        ("stop", Conflict, "nothing but a supervisor stops the arm"),
        ("hold", Conflict, "with φ̂ kept, the law is a PD law"),
        ("stopp", UnknownName, "did you mean `stop`?"),
    ] {
        let (text, line) = with(then);
        check(&text, (line, "contact.then", kind, why));
    }
    assert!(read(&with("report").0).unwrap().contact.is_some());
    let supervised = format!("{}\n[supervisor]\n", with("stop").0);
    assert!(read(&supervised).is_ok());
}
