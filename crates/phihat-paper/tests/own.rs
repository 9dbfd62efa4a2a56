//! The paper's figures and Table 3 on an own arm. Wrong if the mismatch of a sine were not that of (s/(s + r))^m, if PD
//! sagged by anything but gravity over its stiffness, or if a careless study got more or less than one clear line.

use std::f64::consts::TAU;
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

use phihat_model::Workspace;
use phihat_paper::{OwnError, OwnOptions, OwnReproduction, own};
use phihat_study::Study;

const STUDY: &str = "duration_s = 3.0\n[robot]\nname = \"planar3r\"\n[spec]\nsettle_s = 2.0\n\
    [gains]\nkp_per_s2 = 400.0\nkd_per_s = 40.0\na = [900.0, 60.0]\ninertia_kg_m2 = [1.0, 0.5, 0.2]\n\
    [world]\ngravity_m_s2 = [0.0, 0.0, -9.81]\nfriction = \"none\"\n[start]\nq_rad = 0.3\n\
    [reference]\nkind = \"hold\"\nq_rad = 0.3\n";

fn folder(name: &str) -> PathBuf {
    let folder =
        Path::new(env!("CARGO_TARGET_TMPDIR")).join(env!("CARGO_PKG_NAME")).join("own").join(name);
    let _old = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).unwrap();
    folder
}

fn study(text: &str) -> Study {
    Study::from_text(text, "mine.toml", Path::new(".")).unwrap()
}

fn done(text: &str, of: (Option<&Path>, Option<&str>)) -> Result<OwnReproduction, OwnError> {
    own(study(text), Path::new("mine.toml"), of, &|_| ())
}

fn value(own: &OwnReproduction, name: &str) -> f64 {
    let found = own.numbers.iter().find(|number| number.name == name);
    found.unwrap_or_else(|| panic!("{name} is not among {:#?}", own.numbers)).value.unwrap()
}

/// `t_s,phi_nm` of `5 sin ωt`.
fn sine(path: &Path, omega: f64) {
    let mut text = "t_s,phi_nm\n".to_owned();
    for k in 0..9000_u32 {
        let t = f64::from(k) * 1e-3;
        writeln!(text, "{t},{}", 5.0 * (omega * t).sin()).unwrap();
    }
    fs::write(path, text).unwrap();
}

#[test]
fn a_sine_leaves_what_the_filter_leaves() {
    let path = folder("sine").join("phi.csv");
    let omega = TAU;
    sine(&path, omega);
    let own = done(STUDY, (Some(&path), Some("joint2"))).unwrap();
    assert_eq!(own.joint, "joint2");
    // (s + 30)²: both poles at 30 rad/s.
    let r: f64 = 30.0;
    let share = |rate: f64| omega / omega.hypot(rate);
    let near = |is: f64, want: f64| assert!((is / want - 1.0).abs() < 2e-3, "{is} against {want}");
    for factor in [0.25, 0.5, 1.0, 2.0] {
        let name = format!("Fig. 12, joint2: mismatch at m = 1, a_0 = {factor} r");
        near(value(&own, &name), 5.0 * share(factor * r));
        // Whole periods but for a thousandth.
        let root = value(&own, &format!("{name}, rms"));
        assert!((root / (5.0 * share(factor * r) / 2.0_f64.sqrt()) - 1.0).abs() < 5e-3, "{root}");
    }
    for m in 1..=3 {
        let name = format!("Fig. 13, joint2: mismatch at m = {m}");
        near(value(&own, &name), 5.0 * share(r).powi(m));
    }
    near(value(&own, "Fig. 13, joint2: mismatch with the own estimator"), 5.0 * share(r).powi(2));
}

#[test]
fn pd_sags_by_gravity_over_its_stiffness_and_the_proposed_law_does_not() {
    let own = done(STUDY, (None, None)).unwrap();
    let model = study(STUDY).robot.model.with_gravity([0.0, 0.0, -9.81]);
    let mut workspace = Workspace::new(&model);
    let inertia = [1.0, 0.5, 0.2];
    // Where PD comes to rest: M̄ K_p e + g(q_d + e) = 0, by iteration.
    let (mut q, mut g) = ([0.3_f64; 3], [0.0; 3]);
    for _ in 0..500 {
        model.gravity_torque(&mut workspace, &q, &mut g);
        for i in 0..3 {
            q[i] += 0.2 * (0.3 - g[i] / (400.0 * inertia[i]) - q[i]);
        }
    }
    for (i, want) in q.iter().map(|q| (q - 0.3).abs()).enumerate() {
        let of = |what: &str, law: &str| {
            value(&own, &format!("Table 3, joint{}, {what}: rms of e, {law}", i + 1))
        };
        let pd = of("as the study", "PD");
        assert!((pd / want - 1.0).abs() < 1e-2, "joint {i}: {pd} against {want}");
        assert!(of("as the study", "proposed") < 1e-4 * pd.max(1e-2));
        assert!(of("compensated", "PD") < 1e-6);
    }
    assert!(own.left_out.iter().any(|left| left.part.contains("Chung")));
}

#[test]
fn the_printed_form_is_as_welcome() {
    let text = STUDY.replace("[world]", "[loop]\nform = \"literal\"\n[world]");
    let own = done(&text, (None, Some("joint1"))).unwrap();
    assert_eq!(own.joint, "joint1");
    assert_eq!(own.sections.len(), 2);
}

#[test]
fn a_careless_user_gets_one_line() {
    let folder = folder("careless");
    let refused = |text: &str, of: (Option<&Path>, Option<&str>), words: &str| {
        let why = match done(text, of) {
            Err(why) => why.to_string(),
            Ok(_) => panic!("not refused: {words}"),
        };
        assert!(why.contains(words) && !why.contains('\n'), "{words}: {why}");
    };
    let gains = STUDY.find("[gains]").unwrap()..STUDY.find("[world]").unwrap();
    let mut none = STUDY.to_owned();
    none.replace_range(gains.clone(), "[design]\n");
    refused(&none, (None, None), "states no [gains]");
    let mut other = STUDY.to_owned();
    other.replace_range(
        gains,
        "[gains]\norder = 2\nbandwidth_rad_s = 20.0\nestimator_bandwidth_rad_s = 30.0\n\
         inertia_kg_m2 = 1.0\n[loop]\nform = \"positions\"\n",
    );
    refused(&other, (None, None), "loop.form");
    refused(STUDY, (None, Some("elbow")), "joints: joint1, joint2, joint3");
    let wild = STUDY.replace("[1.0, 0.5, 0.2]", "[1000.0, 1000.0, 1000.0]");
    let wild = wild.replace("[world]", "[loop]\ntorque_max_nm = \"none\"\n[world]");
    refused(&wild, (None, None), "no φ: the run ended after");
    let file = folder.join("phi.csv");
    let long = |from: &str| {
        (0..40).fold(from.to_owned(), |text, k| text + &format!("{},1.0\n", 0.001 * f64::from(k)))
    };
    for (text, line, words) in [
        ("time,phi\n0,1\n".to_owned(), "line 1:", "t_s,phi_nm"),
        ("t_s,phi_nm\n0,1\n0.1,x\n".to_owned(), "line 3:", "two numbers"),
        ("t_s,phi_nm\n0,1\n0.1,1\n0.3,1\n".to_owned(), "line 4:", "evenly"),
        ("t_s,phi_nm\n0,1\n".to_owned(), "line 2:", "at least 30"),
        (long("t_s,phi_nm\n") + "0.04,nan\n", "line 42:", "two numbers"),
    ] {
        fs::write(&file, text).unwrap();
        refused(STUDY, (Some(&file), None), words);
        refused(STUDY, (Some(&file), None), line);
    }
    refused(STUDY, (Some(&folder.join("none.csv")), None), "cannot be read");
}

#[test]
fn files_are_whole_and_a_bad_study_leaves_none() {
    let folder = folder("files");
    let options = OwnOptions {
        study: folder.join("mine.toml"),
        out: Some(folder.join("out")),
        ..OwnOptions::default()
    };
    fs::write(&options.study, STUDY.replace("[gains]", "[gain]")).unwrap();
    assert!(options.run(&mut ()).is_err());
    assert!(!folder.join("out").exists());
    fs::write(&options.study, STUDY).unwrap();
    let answer = options.run(&mut ()).unwrap();
    let read = |name: &str| fs::read_to_string(answer.folder.join(name)).unwrap();
    let data: serde_json::Value = serde_json::from_str(&read("own.json")).unwrap();
    assert_eq!(data["study"], "mine");
    assert_eq!(read("study.toml"), STUDY);
    let page = read("report.html");
    for figure in ["own-fig-12", "own-fig-13", "own-fig-14"] {
        assert!(page.contains(figure) && read(&format!("figures/{figure}.svg")).contains("<svg"));
    }
    assert!(page.contains("No verdict on the paper follows"));
}
