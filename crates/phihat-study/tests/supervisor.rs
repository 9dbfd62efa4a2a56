//! `[supervisor]`: what is read, and what is refused. Wrong if keys that contradict each other got through.

use phihat_study::{RequestedMode, Study};

fn study(supervisor: &str) -> Result<Study, phihat_study::StudyError> {
    let text = format!("{}\n[supervisor]\n{supervisor}\n", crate::support::GOOD);
    Study::from_text(&text, "base.toml", "".as_ref())
}

#[test]
fn an_empty_section_has_its_defaults_and_no_section_is_none() {
    assert!(
        Study::from_text(crate::support::GOOD, "base.toml", "".as_ref())
            .unwrap()
            .supervisor
            .is_none()
    );
    let read = study("").unwrap().supervisor.unwrap();
    assert_eq!((read.hold_samples, read.stop_samples), (5, 20));
    assert!(read.requests.is_empty() && read.motion.is_none());
    assert!(read.velocity_max.is_some(), "the robot states it");
    assert!(read.disturbed.is_infinite());
}

#[test]
fn requests_are_read_in_order() {
    let text = "[[supervisor.request]]\nt_s = 0.0\nmode = \"arm\"\n\
                [[supervisor.request]]\nt_s = 1.5\nmode = \"stop\"\n";
    let read = study(text).unwrap().supervisor.unwrap();
    let modes: Vec<_> = read.requests.iter().map(|(_, mode)| *mode).collect();
    assert_eq!(modes, [RequestedMode::Arm, RequestedMode::Stop]);
}

#[test]
fn contradictions_are_refused_by_name() {
    let backwards = "[[supervisor.request]]\nt_s = 2.0\nmode = \"arm\"\n\
                     [[supervisor.request]]\nt_s = 1.0\nmode = \"hold\"\n";
    for (text, key) in [
        ("settled_nm = 2.0\ndisturbed_nm = 1.0", "disturbed_nm"),
        ("reference_velocity_max_rad_s = 1.0", "reference_acceleration_max_rad_s2"),
        ("funnel_initial_rad = 0.01\nfunnel_final_rad = 0.02", "funnel_initial_rad"),
        ("soft_zone_rad = 50.0", "soft_zone_rad"),
        ("hold_samples = 2.5", "hold_samples"),
        ("start_estimator_factor = 1.5", "start_estimator_factor"),
        ("start_estimator_factor = 0.0", "start_estimator_factor"),
        ("error_stop_rad = [0.1, 0.2]", "error_stop_rad"),
        ("[[supervisor.request]]\nt_s = 9.0\nmode = \"arm\"", "t_s"),
        (backwards, "t_s"),
    ] {
        let error = study(text).unwrap_err();
        assert!(error.render().contains(key), "{text}: {}", error.render());
    }
}

#[test]
fn a_slower_start_is_read_and_refused_where_there_is_no_estimator_to_slow() {
    let read = study("start_estimator_factor = 0.25").unwrap().supervisor.unwrap();
    assert_eq!((read.start_factor, read.start_first_order), (Some(0.25), false));
    let positions = crate::support::GOOD.replace("[loop]\n", "[loop]\nform = \"positions\"\n");
    let text = format!("{positions}\n[supervisor]\nstart_estimator_factor = 0.25\n");
    let error = Study::from_text(&text, "base.toml", "".as_ref()).unwrap_err().render();
    assert!(
        error.contains("start_estimator_factor") && error.contains("law from positions"),
        "{error}"
    );
}

/// Limits of the motion to the park posture.
const SHAPED: &str = "reference_velocity_max_rad_s = 0.5\nreference_acceleration_max_rad_s2 = \
    2.0\nreference_jerk_max_rad_s3 = 20.0\n";

#[test]
fn where_an_arm_parks_is_read_as_positions_or_by_name() {
    let parks = |text: &str| study(&format!("{SHAPED}{text}")).map(|s| s.supervisor.unwrap().park);
    assert_eq!(parks("").unwrap(), None);
    assert_eq!(parks("park_rad = [0.1, -0.2, 0.3]").unwrap(), Some(vec![0.1, -0.2, 0.3]));
    let named = study(SHAPED).unwrap().robot.poses["ready"].clone();
    assert_eq!(parks("park = \"ready\"").unwrap(), Some(named));
    for (text, key, why) in [
        ("park = \"redy\"", "supervisor.park", "did you mean `ready`"),
        ("park_rad = [0.1, 0.2]", "supervisor.park_rad", "3"),
        ("park_rad = [0.1, 0.2, 50.0]", "supervisor.park_rad", "joint3"),
        ("park_rad = [0.0, 0.0, nan]", "supervisor.park_rad", "finite"),
        ("park = \"ready\"\npark_rad = 0.0", "supervisor.park", "park_rad"),
        ("park = \"ready\"\nbrake_closing_s = 0.1", "supervisor.park", "with brakes"),
    ] {
        let error = parks(text).unwrap_err().render();
        assert!(error.contains(key) && error.contains(why), "{text}: {error}");
    }
    let error = study("park = \"ready\"").unwrap_err().render();
    assert!(error.contains("reference_velocity_max_rad_s"), "{error}");
}
