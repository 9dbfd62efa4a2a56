//! A bound for every motion of a class on the page. Wrong if its verdict, its band or its table said another number
//! than the document, if a run beyond it were not called so, or if a run that it says nothing of were held against it.
#![allow(clippy::float_cmp, reason = "in a test a panic is the report")]

use phihat_design::{
    ClassBound, ClassPace, ClassPart, LeftOut, NotCounted, TubePayloadSet, Verdict,
};
use phihat_report::{RecordedBound, claimed_bound, figures, page, scope_of_bound, stop_in_words};
use phihat_sim::{ContactEvent, ContactRecord, Stopped};
use roxmltree::Document;
use scraper::{Html, Selector};

use crate::claims::certified;
use crate::support::{Fixture, fixture};

/// Bounds a quarter above the measurements of a run in which no limit acts.
pub(crate) fn of_class() -> Fixture {
    let mut fixture = fixture(3, 2_400);
    fixture.gains = certified();
    fixture.run.study_sha256.clone_from(&fixture.gains.study_sha256);
    for joint in &mut fixture.metrics.joints {
        (joint.saturated_samples, joint.saturated_steady_samples) = (0, 0);
        joint.tau_step_limit_nm = Some(50.0);
    }
    let joints = &fixture.metrics.joints;
    let above =
        |of: fn(&phihat_sim::JointMetrics) -> f64| joints.iter().map(|j| 1.25 * of(j)).collect();
    let class = ClassBound {
        box_rad: (vec![-0.3, 0.7, -1.3], vec![0.3, 1.3, -0.7]),
        speed_max_rad_s: vec![0.2; 3],
        acceleration_max_rad_s2: vec![0.4, 0.4, 0.6],
        jerk_max_rad_s3: vec![1.0; 3],
        payload: TubePayloadSet {
            frame: "tool".into(),
            mass_kg: (0.0, 1.5),
            com_m: [(0.0, 0.0); 3],
            gyration_m: 0.0,
        },
        force_nm: vec![0.3; 3],
        start_nm: vec![0.0; 3],
        start_s: 0.0,
        reading_rad: vec![1e-5; 3],
        signals: None,
        error_bound_rad: above(|j| j.error_peak_rad),
        velocity_error_bound_rad_s: above(|j| j.velocity_error_steady_max_rad_s),
        torque_step_nm: above(|j| j.tau_step_max_nm),
        torque_nm: above(|j| j.tau_max_nm),
        frozen_error_bound_rad: above(|j| 0.5 * j.error_peak_rad),
        spectral_radius: 0.149,
        postures: 101,
        points: 4385,
        source: "searched: corners".into(),
        witnesses: Vec::new(),
        paces: vec![pace(0.5, Some(0.01)), pace(2.0, Some(0.2)), pace(3.0, None)],
        parts: Vec::new(),
    };
    fixture.gains.certificate.as_mut().unwrap().class = Some(Box::new(class));
    fixture
}

fn pace(factor: f64, error_bound_rad: Option<f64>) -> ClassPace {
    ClassPace {
        factor,
        error_bound_rad,
        torque_step_nm: error_bound_rad,
        spectral_radius: factor / 6.0,
    }
}

fn class(fixture: &mut Fixture) -> &mut ClassBound {
    fixture.gains.certificate.as_mut().unwrap().class.as_deref_mut().unwrap()
}

/// Class and text of the box with the bound's standing.
fn standing(fixture: &Fixture) -> (String, String) {
    let page = Html::parse_document(&page(&fixture.record()));
    let found = Selector::parse("#standing").unwrap();
    let node = page.select(&found).next().unwrap();
    // Without the marks that keep a magnitude on one line.
    let text = node.text().collect::<Vec<_>>().join(" ").replace('\u{2060}', "");
    let words = text.split_whitespace().collect::<Vec<_>>().join(" ");
    (node.attr("class").unwrap().to_owned(), words)
}

#[test]
fn the_standing_says_word_bound_measurement_and_scope() {
    let mut fixture = of_class();
    let (class, text) = standing(&fixture);
    assert_eq!(class, "standing unproved");
    // The third joint starts farthest away: 70 mrad.
    let worst = &fixture.metrics.joints[2];
    assert!((worst.error_peak_rad - 0.07).abs() < 1e-3);
    let bound = format!("|e| ≤ {:.2} mrad", 1250.0 * worst.error_peak_rad);
    let measured = format!("measured {:.2} mrad", 1e3 * worst.error_peak_rad);
    for part in [
        "NOT PROVED",
        "claimed",
        &bound,
        &measured,
        "derived once",
        "any motion within ±0.3 rad, 0.2 rad/s, 0.4 … 0.6 rad/s², 1 rad/s³",
        "payload 0 … 1.5 kg on tool",
        "other forces up to 0.3 N·m",
        "limits silent",
        "assumptions hold",
    ] {
        assert!(text.contains(part), "{part}: {text}");
    }
    // As it was checked: the wider bounds, and the word.
    let each = |scale: f64| fixture.metrics.joints.iter().map(move |j| scale * j.error_peak_rad);
    let checked = RecordedBound {
        verdict: Verdict::DerivedTwice,
        error_bound_rad: each(1.5).collect(),
        words: String::new(),
    };
    fixture.run.bound = Some(checked);
    let (class, text) = standing(&fixture);
    assert_eq!(class, "standing proved");
    let bound = format!(
        "DERIVED TWICE |e| ≤ {:.1} mrad",
        1500.0 * fixture.metrics.joints[2].error_peak_rad
    );
    assert!(text.starts_with(&bound) && !text.contains("NOT PROVED"), "{text}");
    // Of a run in which a limit acted nothing is claimed.
    fixture.metrics.joints[1].rate_limited_samples = 1;
    let (class, text) = standing(&fixture);
    assert!(class == "standing unproved" && text.contains("limits acted on 1 commands"), "{text}");
}

#[test]
fn a_run_beyond_the_bound_is_called_so_where_the_bound_is_a_promise() {
    let mut broken = of_class();
    class(&mut broken).error_bound_rad[1] *= 0.5;
    let (kind, text) = standing(&broken);
    assert_eq!(kind, "standing broken");
    assert!(text.starts_with("BROKEN") && text.contains("please report"), "{text}");
    assert!(text.contains("joint2: |e|"), "{text}");
    let claimed = claimed_bound(&broken.record()).unwrap();
    assert!(claimed.promised && claimed.broken && claimed.sentence.contains("please report"));
    assert_eq!(claimed.error_bound_rad, class(&mut broken).error_bound_rad);
    // Not where a limit acted, nor for another study.
    let mut limited = broken.clone();
    limited.metrics.joints[0].rate_limited_samples = 1;
    let mut other = broken;
    other.run.study_sha256 = "fedcba9876543210".repeat(4);
    for (fixture, why) in [(limited, "a limit acted"), (other, "another study")] {
        let (kind, text) = standing(&fixture);
        assert!(kind == "standing unproved" && text.contains(why), "{text}");
        assert!(!text.contains("please report"), "{text}");
        let claimed = claimed_bound(&fixture.record()).unwrap();
        assert!(!claimed.promised && !claimed.broken && claimed.motions.is_some());
    }
    // What only stops the arm takes nothing away from a run without a stop; what changes the loop does.
    let not_counted = |key: &str| {
        let mut fixture = of_class();
        let entry = NotCounted {
            key: key.to_owned(),
            value: "1".to_owned(),
            claims: LeftOut::BoundsAndStability,
        };
        fixture.gains.certificate.as_mut().unwrap().not_counted.push(entry);
        claimed_bound(&fixture.record()).unwrap().promised
    };
    assert!(not_counted("supervisor.velocity_max_rad_s"));
    assert!(not_counted("supervisor: a safe stop"));
    assert!(!not_counted("supervisor.dead_zone_rad"));
    let mut much = of_class();
    let clauses = &mut much.gains.certificate.as_mut().unwrap().unproved;
    clauses.push("error_bound_rad = 1e-9 on joint1".to_owned());
    assert!(standing(&much).1.contains("error_bound_rad = 1e-9 on joint1"));
    let mut refused = of_class();
    let certificate = refused.gains.certificate.as_mut().unwrap();
    (certificate.class, certificate.class_refused) = (None, Some("too <fast>".to_owned()));
    let (kind, text) = standing(&refused);
    assert!(kind == "standing unproved" && text.contains("too <fast>"), "{text}");
}

#[test]
fn where_contacts_are_watched_the_bound_is_of_an_arm_that_nothing_touches() {
    let mut fixture = of_class();
    let said =
        |fixture: &Fixture| scope_of_bound(Some(&fixture.gains), &fixture.metrics, &fixture.run);
    let free = said(&fixture);
    assert!(free.starts_with(", for any motion within ±0.3 rad"), "{free}");
    assert!(!free.contains("touches") && !standing(&fixture).1.contains("touches"));
    let event = ContactEvent {
        t_s: 0.5,
        until_s: 0.6,
        joint: "joint2".into(),
        beyond_nm: 1.0,
        force_n: None,
    };
    fixture.run.contact = Some(ContactRecord { events: vec![event], ..ContactRecord::default() });
    let words = "as long as nothing touches the arm";
    assert_eq!(said(&fixture), format!("{free}, {words}"));
    assert!(standing(&fixture).1.contains(words), "{}", standing(&fixture).1);
    let touched =
        "Something touched the arm at t = 0.5 s (joint2): from then on the bound is no promise";
    assert!(standing(&fixture).1.contains(touched), "{}", standing(&fixture).1);
    // A stop that nothing else explains follows the contact just before it, on the page as in the terminal.
    let stopped = |t_s: f64, fault: Option<&str>| {
        let mut fixture = fixture.clone();
        let (fault, mode) = (fault.map(str::to_owned), "safe-stop".to_owned());
        fixture.metrics.stopped = Some(Box::new(Stopped { t_s, fault, brake_s: None, mode }));
        let words = stop_in_words(&fixture.metrics, &fixture.run).unwrap();
        assert!(page(&fixture.record()).contains(&words), "{words}");
        words
    };
    let follows = "it follows the contact at t = 0.500 s on joint2";
    assert!(stopped(0.501, None).contains(follows));
    for other in [stopped(0.499, None), stopped(0.9, None), stopped(0.501, Some("overspeed"))] {
        assert!(!other.contains("follows"), "{other}");
    }
}

/// Numbers of a path, whatever its letters.
fn numbers(path: &str) -> Vec<f64> {
    let split = |c: char| c.is_ascii_alphabetic() || c == ' ' || c == ',';
    path.split(split).filter(|part| !part.is_empty()).map(|part| part.parse().unwrap()).collect()
}

#[test]
fn the_error_of_every_joint_is_drawn_in_its_band() {
    let mut fixture = of_class();
    // Twice as far as the axis is high for the curve alone.
    class(&mut fixture).error_bound_rad = vec![0.1, 0.1, 0.2];
    let drawn = figures(&fixture.record());
    let svg = &drawn.iter().find(|figure| figure.name == "error").unwrap().svg;
    let document = Document::parse(svg).unwrap();
    let bands = document.descendants().filter(|n| n.attribute("class") == Some("f2"));
    let bands: Vec<Vec<f64>> = bands.filter_map(|n| n.attribute("d")).map(numbers).collect();
    assert_eq!(bands.len(), 3, "one for each joint");
    let ticks: Vec<(f64, f64)> = document
        .descendants()
        .filter(|n| {
            n.attribute("class") == Some("tick") && n.attribute("text-anchor") == Some("end")
        })
        .map(|n| (n.text().unwrap().parse().unwrap(), n.attribute("y").unwrap().parse().unwrap()))
        .collect();
    // Ticks of the first panel: until values begin again.
    let count = 1 + ticks.windows(2).take_while(|pair| pair[1].0 > pair[0].0).count();
    let (low, high) = (ticks[0], ticks[count - 1]);
    let per_mrad = (low.1 - high.1) / (high.0 - low.0);
    let [_, top, _, bottom, _] = bands[0][..] else { panic!("{:?}", bands[0]) };
    assert!((bottom - top - 200.0 * per_mrad).abs() < 0.5, "{} {per_mrad}", bottom - top);
    let page = page(&fixture.record());
    assert!(page.contains("\"band_label\":\"class bound ±100.0 mrad\""));
    assert!(page.contains("in the class bound (shaded)"));
}

#[test]
fn other_paces_are_drawn_and_those_without_a_bound_are_named() {
    let fixture = of_class();
    let drawn = figures(&fixture.record());
    let svg = &drawn.iter().find(|figure| figure.name == "pace").unwrap().svg;
    assert!(svg.contains("f = 3: no bound"), "{svg}");
    // Two paces and the class itself, in two panels; a ring around the class.
    let document = Document::parse(svg).unwrap();
    let marks = document
        .descendants()
        .filter(|n| n.attribute("class") == Some("f0") && n.attribute("fill-opacity").is_none());
    let marks: usize = marks.filter_map(|n| n.attribute("d")).map(|d| d.matches('M').count()).sum();
    assert_eq!((marks, svg.matches("<circle").count()), (2 * 4, 2));
}

#[test]
fn parts_of_a_bound_stand_in_rows_with_their_sum() {
    let mut fixture = of_class();
    let part = |name: &str, error: f64| ClassPart {
        name: name.to_owned(),
        error_bound_rad: vec![error, 2.0 * error, 0.0],
        torque_step_nm: vec![0.25; 3],
    };
    class(&mut fixture).parts = vec![part("the motion", 1e-4), part("dry friction", 2e-4)];
    let page = Html::parse_document(&page(&fixture.record()));
    let text = |td: scraper::ElementRef<'_>| td.text().collect::<String>().parse().unwrap();
    let row = |label: &str, head: &str| -> Vec<f64> {
        let select = |css: &str| Selector::parse(css).unwrap();
        let table = page.select(&select(&format!("[aria-label='{label}'] tr"))).find(|row| {
            row.select(&select("th")).next().is_some_and(|th| th.inner_html().contains(head))
        });
        table.unwrap().select(&select("td")).map(text).collect()
    };
    let error = "Table: parts of the class bound on |e|";
    assert_eq!(row(error, "dry friction"), [0.2, 0.4, 0.0]);
    assert_eq!(row(error, "together"), [0.3, 0.6, 0.0]);
    assert_eq!(row("Table: parts of the class bound on |Δτ|", "together"), [0.5, 0.5, 0.5]);
}

#[test]
fn lists_of_another_length_break_no_page() {
    let mut fixture = of_class();
    let class = class(&mut fixture);
    class.parts = vec![ClassPart {
        name: "a <part>".to_owned(),
        error_bound_rad: Vec::new(),
        torque_step_nm: vec![f64::NAN],
    }];
    class.error_bound_rad.truncate(1);
    class.box_rad.0.clear();
    class.speed_max_rad_s = vec![f64::NAN; 9];
    class.paces[0].factor = f64::NAN;
    assert!(page(&fixture.record()).contains("any motion within"));
    for figure in figures(&fixture.record()) {
        Document::parse(&figure.svg).unwrap_or_else(|e| panic!("{}: {e}", figure.name));
    }
}
