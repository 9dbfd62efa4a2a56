//! Options that are refused before an arm starts. Wrong if an option passes that means nothing, if a sound
//! one does not, or if the message does not say which joint, option and value.
#![allow(clippy::large_types_passed_by_value, reason = "a test reads better so")]

use crate::arm::{FIRST, T_NS, gains};
use phihat::{
    Events, Funnel, JointOptions, JointRange, MotionLimits, OptionError, Options, Schedule,
    Supervisor,
};

const NOT_POSITIVE: [f64; 4] = [0.0, -1.0, f64::NAN, f64::INFINITY];

/// Why an arm of two joints is refused, whose second has these options.
fn refused(joint: JointOptions<f64>, options: &Options) -> Option<OptionError> {
    let joints = [JointOptions::default(), joint];
    Supervisor::new([gains(FIRST); 2], &joints, options).err()
}

fn said(error: Option<OptionError>) -> String {
    error.map_or_else(|| "nothing".to_owned(), |error| error.to_string())
}

#[test]
fn an_option_of_the_arm_that_is_not_positive_is_refused_by_its_name() {
    type Set = fn(&mut Options, f64);
    let all: [(&str, Set); 8] = [
        ("rest velocity", |o, x| o.rest_velocity = x),
        ("start mismatch", |o, x| o.start_mismatch_max = x),
        ("blend time", |o, x| o.blend_s = x),
        ("stop time", |o, x| o.stop_s = x),
        ("saturation time", |o, x| o.saturation_s = Some(x)),
        ("brakes' closing time", |o, x| o.brake_s = Some(x)),
        ("schedule settled", |o, x| o.schedule.settled = x),
        ("schedule dwell", |o, x| o.schedule.dwell_s = x),
    ];
    for (name, set) in all {
        for x in NOT_POSITIVE {
            let mut options = Options::new(T_NS);
            set(&mut options, x);
            let want = format!("joint 0: {name} is {x}; it must be positive and finite");
            assert_eq!(said(refused(JointOptions::default(), &options)), want);
        }
        let mut options = Options::new(T_NS);
        set(&mut options, 1e-9);
        assert_eq!(refused(JointOptions::default(), &options), None, "{name}");
    }
}

#[test]
fn an_option_of_the_arm_beyond_its_range_is_refused() {
    let with = |set: &dyn Fn(&mut Options)| {
        let mut options = Options::new(T_NS);
        set(&mut options);
        said(refused(JointOptions::default(), &options))
    };
    for (x, is) in
        [(-1e-9, false), (0.0, true), (1.0, true), (1.0 + 1e-9, false), (f64::NAN, false)]
    {
        let told = with(&|o| o.stop_damping = x);
        let want = format!("joint 0: stop damping is {x}; it must be 0 … 1");
        assert_eq!(told, if is { "nothing".to_owned() } else { want });
    }
    assert!(with(&|o| o.stop_samples = 0).contains("stop samples is 0; it must be at least 1"));
    assert!(with(&|o| o.bad_samples = 0).contains("bad samples is 0; it must be at least 1"));
    assert_eq!(with(&|o| (o.stop_samples, o.bad_samples) = (1, 1)), "nothing");
    for (disturbed, is) in [(0.5, false), (1.0, false), (1.0 + 1e-9, true), (f64::NAN, false)] {
        let schedule = Schedule { settled: 1.0, disturbed, dwell_s: 0.1 };
        let told = with(&|o| o.schedule = schedule);
        assert_eq!(told.contains("schedule disturbed"), !is, "{told}");
    }
    // One second and no longer; gains for that period are refused or not by themselves.
    for (period_ns, named) in [(0, true), (1_000_000_000, false), (1_000_000_001, true)] {
        let told = with(&|o| o.period_ns = period_ns);
        assert_eq!(told.starts_with("joint 0: period is"), named, "{told}");
        let other = "joint 0: its gains are for another sample period than the options";
        assert!(named || told == other, "{told}");
    }
}

#[test]
fn an_option_of_a_joint_that_is_not_positive_is_refused_by_its_name() {
    const RANGE: JointRange = JointRange { lower: -1.0, upper: 1.0, soft: 0.1, braking: 5.0 };
    const FUNNEL: Funnel = Funnel { initial: 0.1, r#final: 0.05, decay_s: 0.1 };
    type Set = fn(&mut JointOptions<f64>, f64);
    let all: [(&str, Set); 11] = [
        ("velocity limit", |j, x| j.velocity_max = Some(x)),
        ("error limit", |j, x| j.error_stop = Some(x)),
        ("error bound", |j, x| j.error_bound = Some(x)),
        ("frozen travel", |j, x| j.frozen_travel = Some(x)),
        ("dead zone", |j, x| j.dead_zone = Some(x)),
        ("oscillation", |j, x| j.oscillation = Some(x)),
        ("first motion", |j, x| j.first_motion = Some(x)),
        ("braking deceleration", |j, x| j.range = Some(JointRange { braking: x, ..RANGE })),
        ("width of the range", |j, x| j.range = Some(JointRange { upper: x - 1.0, ..RANGE })),
        ("final funnel width", |j, x| j.funnel = Some(Funnel { r#final: x, ..FUNNEL })),
        ("funnel decay", |j, x| j.funnel = Some(Funnel { decay_s: x, ..FUNNEL })),
    ];
    for (name, set) in all {
        for x in NOT_POSITIVE {
            let mut joint = JointOptions::default();
            set(&mut joint, x);
            let want = format!("joint 1: {name} is {x}; it must be positive and finite");
            assert_eq!(said(refused(joint, &Options::new(T_NS))), want);
        }
    }
    let fits = |joint| refused(joint, &Options::new(T_NS)).is_none();
    // Soft zones that meet leave nothing in between; a funnel does not get wider.
    for (soft, is) in [(0.0, false), (1e-9, true), (0.999, true), (1.0, false), (f64::NAN, false)] {
        let range = Some(JointRange { soft, ..RANGE });
        assert_eq!(fits(JointOptions { range, ..JointOptions::default() }), is, "{soft}");
    }
    for (initial, is) in [(0.05, true), (0.049, false), (f64::INFINITY, false), (f64::NAN, false)] {
        let funnel = Some(Funnel { initial, ..FUNNEL });
        assert_eq!(fits(JointOptions { funnel, ..JointOptions::default() }), is, "{initial}");
    }
}

#[test]
fn limits_of_a_motion_or_of_a_stop_that_mean_nothing_are_refused() {
    const MOTION: MotionLimits = MotionLimits { velocity: 1.0, acceleration: 5.0, jerk: 100.0 };
    // A box without limits of the motion, or without a width.
    let reference_box = Some((-1.0, 1.0));
    let error =
        refused(JointOptions { reference_box, ..JointOptions::default() }, &Options::new(T_NS));
    assert!(said(error).starts_with("joint 1: box of the reference is 2; it must be left out"));
    for upper in [-1.0, -1.000_001, -2.0, f64::NAN, f64::INFINITY] {
        let (motion, reference_box) = (Some(MOTION), Some((-1.0, upper)));
        let joint = JointOptions { motion, reference_box, ..JointOptions::default() };
        let error = refused(joint, &Options::new(T_NS));
        assert!(matches!(error, Some(OptionError::Motion { joint: 1, .. })), "{upper}: {error:?}");
    }
    for acceleration in NOT_POSITIVE {
        let limits = Some(MotionLimits { acceleration, ..MOTION });
        for joint in [
            JointOptions { motion: limits, ..JointOptions::default() },
            JointOptions { stop: limits, ..JointOptions::default() },
        ] {
            let error = refused(joint, &Options::new(T_NS));
            assert!(matches!(error, Some(OptionError::Motion { joint: 1, .. })), "{error:?}");
            assert!(said(error).starts_with("joint 1: "));
        }
    }
    let error = OptionError::Form { joint: 3 };
    assert_eq!(error.to_string(), "joint 3: start gains need the form of the running gains");
}

/// The events of a sample are a set: an event that is put in twice is in it once.
#[test]
fn events_are_a_set() {
    let some = Events::MISSED | Events::AGED;
    assert!(some.contains(Events::MISSED) && some.contains(Events::AGED) && some.contains(some));
    assert!(!some.contains(Events::RANGE) && !some.contains(some | Events::RANGE));
    assert_eq!((some | Events::AGED, some | some, some | Events::NONE), (some, some, some));
    let mut grown = some;
    grown |= Events::AGED;
    grown |= Events::RANGE;
    assert_eq!(grown.names().collect::<Vec<_>>(), ["missed", "aged", "range"]);
    assert!(Events::NONE.is_empty() && !some.is_empty());
    // In a record each has its own bit, in the order of the list.
    let bits: Vec<u32> = Events::ALL.iter().map(|(event, _)| event.bits()).collect();
    assert_eq!(bits, (0..22).map(|n| 1 << n).collect::<Vec<u32>>());
}
