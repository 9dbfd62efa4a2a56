//! The figures of the claims show the certificate's numbers. Wrong if a bar, a point or a unit were not the one of the
//! data, or if a file with nonsense in it broke the page.

use std::path::Path;
use std::sync::OnceLock;

use phihat_design::{
    Arm, FilterSection, Gains, JointLimit, Outcome, Phi, PhiBasis, PositionObserver, design,
};
use phihat_report::{FIGURES, figures, page};
use phihat_study::Study;
use roxmltree::Document;
use scraper::{ElementRef, Html, Selector};

use crate::support::{Fixture, fixture};

/// Designed once: it takes a second.
pub(crate) fn certified() -> Gains {
    static GAINS: OnceLock<Gains> = OnceLock::new();
    GAINS.get_or_init(designed).clone()
}

fn designed() -> Gains {
    let text = "duration_s = 4.0\n[robot]\nname = \"planar3r\"\n[spec]\nsettle_s = 2.0\nerror_bound_rad = \
                4e-3\n[design]\ninertia_low_kg_m2 = [0.2, 0.1, 0.02]\ninertia_high_kg_m2 = [0.5, 0.3, 0.05]\n[sensor]\n\
                encoder_bits = 18\n[reference]\nkind = \"hold\"\nq_rad = 0.0\n";
    let study =
        Study::from_text(text, "arm.toml", Path::new(".")).unwrap_or_else(|e| panic!("{e}"));
    let phi = |_: usize, _: f64| Phi {
        basis: PhiBasis::Typed,
        source: "typed".to_owned(),
        size_nm: None,
        rate_nm_s: 5.0,
        jump_nm: 0.1,
        motion: None,
    };
    match design(&study, &Arm::of(&study).unwrap(), &phi).unwrap() {
        Outcome::Designed(gains) => *gains,
        Outcome::Infeasible(no) => panic!("{no:?}"),
    }
}

fn with(gains: Gains) -> Fixture {
    let mut fixture = fixture(3, 600);
    fixture.gains = gains;
    fixture
}

fn svg(fixture: &Fixture, name: &str) -> Option<String> {
    figures(&fixture.record()).into_iter().find(|f| f.name == name).map(|f| f.svg)
}

fn words(svg: &str) -> String {
    let document = Document::parse(svg).unwrap();
    document
        .descendants()
        .filter(|n| {
            n.is_text() && n.parent_element().is_some_and(|p| p.tag_name().name() == "text")
        })
        .filter_map(|n| n.text())
        .collect::<Vec<_>>()
        .join(" ")
}

/// Left edge and width of every bar of a colour: `M left top H right V bottom H left z`.
fn bars(svg: &str, fill: &str) -> Vec<(f64, f64)> {
    let document = Document::parse(svg).unwrap();
    let of =
        |n: &roxmltree::Node<'_, '_>| n.has_tag_name("path") && n.attribute("fill") == Some(fill);
    let path = document.descendants().find(of).and_then(|n| n.attribute("d")).unwrap_or_default();
    let bar = |bar: &str| {
        let left: f64 = bar.split(' ').next().unwrap().parse().unwrap();
        let right: f64 = bar.split(['H', 'V']).nth(1).unwrap().parse().unwrap();
        (left, right - left)
    };
    path.split('M').skip(1).map(bar).collect()
}

/// Marks of a shape in a figure: those of the key and of the data.
fn marks(svg: &str, class: &str) -> usize {
    let document = Document::parse(svg).unwrap();
    let of = document.descendants().filter(|n| n.attribute("class") == Some(class));
    of.filter_map(|n| n.attribute("d")).map(|d| d.matches('M').count()).sum()
}

#[test]
fn bars_are_the_windows_and_the_ranges() {
    let fixture = with(certified());
    let certificate = fixture.gains.certificate.as_ref().unwrap();
    let drawn = svg(&fixture, "inertia-window").unwrap();
    let (windows, arms) = (bars(&drawn, "#A8D6F0"), bars(&drawn, "#0072B2"));
    assert_eq!((windows.len(), arms.len()), (3, 3));
    let first = &fixture.gains.joints[0];
    let window = certificate.joints[0].window.unwrap();
    let per_e = windows[0].1 / (window.high / window.low).ln();
    for (j, joint) in fixture.gains.joints.iter().enumerate() {
        let shift = per_e * (joint.inertia_kg_m2 / first.inertia_kg_m2).ln();
        assert!((windows[j].0 - windows[0].0 - shift).abs() < 0.4, "joint {j}: window");
        let inside = per_e * (certificate.arm.low / window.low).ln();
        assert!((arms[j].0 - windows[j].0 - inside).abs() < 0.4, "joint {j}: low end of the arm");
        let width = per_e * (certificate.arm.high / certificate.arm.low).ln();
        assert!((arms[j].1 - width).abs() < 0.4, "joint {j}: width of the arm");
        assert!(words(&drawn).contains(&joint.name));
    }
    assert!(words(&drawn).contains("kg·m²"));
}

/// Text of the cells of a table's rows.
fn cells(page: &str, label: &str) -> Vec<Vec<String>> {
    let document = Html::parse_document(page);
    let select = |text: &str| Selector::parse(text).unwrap();
    let rows = select(&format!("div[aria-label='{label}'] tbody tr"));
    let text = |cell: ElementRef<'_>| cell.text().collect::<String>();
    document.select(&rows).map(|row| row.select(&select("th, td")).map(text).collect()).collect()
}

#[test]
fn a_filter_on_the_innovation_is_told_by_its_poles_and_weights() {
    let filter = "Table: filter on the innovation per joint";
    let mut fixture = fixture(3, 600);
    assert!(cells(&page(&fixture.record()), filter).is_empty());
    // s = −100 ± 200j rad/s, and −50 and −400 rad/s, at 1 kHz: z by sum and product.
    let [decay, slow, fast] = [(-0.1_f64).exp(), (-0.05_f64).exp(), (-0.4_f64).exp()];
    let section = |sum: f64, product: f64, weights_per_s2| FilterSection {
        rates: [1.0 - sum + product, 2.0 - sum],
        weights_per_s2,
    };
    let pair = section(2.0 * decay * 0.2_f64.cos(), decay * decay, [800.0, -300.0]);
    let apart = section(slow + fast, slow * fast, [12.5, 0.0]);
    for (joint, innovation_filter) in
        fixture.gains.joints.iter_mut().zip([vec![pair, apart], Vec::new(), vec![apart]])
    {
        joint.a.clear();
        let correction = vec![0.271, 28.5, -1000.0];
        let own = PositionObserver { correction, share: 0.5, delay_samples: 1, innovation_filter };
        joint.observer = Some(own);
    }
    let page = page(&fixture.record());
    let apart = ["−50.00, −400.0", "12.5", "0"];
    let expected = [
        ["joint1", "−100.0 ± 200.0j", "800", "-300"],
        ["joint1", apart[0], apart[1], apart[2]],
        ["joint3", apart[0], apart[1], apart[2]],
    ];
    assert_eq!(cells(&page, filter), expected);
    assert_eq!(cells(&page, "Table: gains per joint").len(), 3);
    assert!(page.contains("x ← x + δ and δ ← δ + ν − c_0 x − c_1 δ"), "the law is stated");
}

#[test]
fn every_point_of_the_trade_off_and_every_ratio_is_drawn() {
    let fixture = with(certified());
    let points = &fixture.gains.trade_off;
    let drawn = svg(&fixture, "trade-off").unwrap();
    for (high, class) in [(false, "f0"), (true, "f1")] {
        let of = points.iter().filter(|p| (p.order > 1) == high);
        let (count, chosen) = (of.clone().count(), of.filter(|p| p.chosen).count());
        assert_eq!(marks(&drawn, class), count + chosen + usize::from(count > 0), "{class}");
    }
    assert_eq!(drawn.matches("<circle").count(), 1, "a ring around the chosen one");
    assert!(words(&drawn).contains("these gains") && words(&drawn).contains("[N·m]"));
    let bode = words(&svg(&fixture, "bode").unwrap());
    for part in ["frequency [Hz]", "phase [°]", "|L/μ|", "mrad/(N·m)", "-180"] {
        assert!(bode.contains(part), "{part}: {bode}");
    }
    assert_eq!(bode.matches("μ = ").count(), 3);
    let html = page(&fixture.record());
    assert_eq!(html.matches("class=\"claim\"").count(), 4);
}

/// Oracle: the window's ends and the modulus margin in the document.
#[test]
fn the_nyquist_plot_names_the_ends_of_the_window_and_the_circle() {
    let fixture = with(certified());
    let certificate = fixture.gains.certificate.as_ref().unwrap();
    let margin = |joint: &&phihat_design::JointCertificate| joint.margins.unwrap().modulus;
    let least = |a: &&phihat_design::JointCertificate, b: &&phihat_design::JointCertificate| {
        margin(a).total_cmp(&margin(b))
    };
    let tightest = certificate.joints.iter().min_by(least).unwrap();
    let (window, nyquist) = (tightest.window.unwrap(), svg(&fixture, "nyquist").unwrap());
    let number = phihat_report::kit::number::number;
    let said = words(&nyquist);
    for part in [
        format!("lower end {}", number(window.low)),
        format!("modulus margin {}", number(margin(&tightest))),
        "−1".to_owned(),
        format!("μ = {}", number(certificate.arm.low)),
    ] {
        assert!(said.contains(&part), "{part}: {said}");
    }
    // Where the loop of the lightest arm crosses the axis next to −1.
    let place = -window.low / certificate.arm.low;
    assert!(place > -1.0 && place < 0.0, "{place}");
}

#[test]
fn nonsense_in_the_file_leaves_its_figure_out() {
    assert_eq!(svg(&fixture(3, 600), "bode"), None);
    let spoil: [fn(&mut Gains); 6] = [
        |g| g.certificate.as_mut().unwrap().arm.low = -1.0,
        |g| g.certificate.as_mut().unwrap().arm.high = f64::NAN,
        |g| g.certificate.as_mut().unwrap().joints.clear(),
        |g| g.joints.clear(),
        |g| g.joints.iter_mut().for_each(|j| j.a = vec![f64::NAN; 9]),
        |g| {
            for joint in &mut g.certificate.as_mut().unwrap().joints {
                joint.model.delay_samples = u32::MAX;
            }
            g.trade_off.iter_mut().for_each(|p| p.error_share = f64::INFINITY);
        },
    ];
    for spoil in spoil {
        let mut gains = certified();
        spoil(&mut gains);
        let fixture = with(gains);
        assert!(page(&fixture.record()).contains("Certificate"));
        assert_eq!(svg(&fixture, "bode"), None);
    }
}

/// Figures of an older page are removed by these names.
#[test]
fn the_name_of_every_figure_is_listed() {
    let mut drawn: Vec<_> =
        figures(&with(certified()).record()).into_iter().map(|figure| figure.name).collect();
    drawn.extend(["velocity-error", "error-integral", "torque-step", "pace"].map(String::from));
    let listed = |name: &String| FIGURES.contains(&name.as_str());
    assert!(drawn.iter().all(listed), "{drawn:?}");
    let missing: Vec<_> = FIGURES.iter().filter(|name| !drawn.iter().any(|d| d == *name)).collect();
    assert_eq!(missing, Vec::<&&str>::new(), "listed, and no record has it");
}

#[test]
fn names_cannot_leave_a_figure() {
    for payload in crate::support::hostile::PAYLOADS {
        let fixture = with(certified()).named(payload);
        for figure in figures(&fixture.record()) {
            Document::parse(&figure.svg).unwrap_or_else(|e| panic!("{}: {e}", figure.name));
        }
    }
}

#[test]
fn laws_beside_the_limit_are_told_where_somebody_asked() {
    let told = "beside the limit of linear laws";
    assert!(!page(&with(certified()).record()).contains(told));
    let mut gains = certified();
    gains.limit = vec![JointLimit {
        name: gains.joints[0].name.clone(),
        phi_source: "typed in the study".to_owned(),
        phi_rate_nm_s: 2.0,
        phi_jump_nm: 0.3,
        torque_noise_nm: 0.6,
        limit_rad: (1e-4, 1e-4),
        limit_lightest_rad: (1.25e-4, 1.25e-4),
        own_rad: 1.5e-4,
        range_rad: 3.5e-4,
    }];
    // As a file, and back; the certificate holds as before.
    let gains = Gains::from_json(&gains.to_json().unwrap()).unwrap();
    gains.certificate.as_ref().unwrap().verify(&gains).unwrap();
    let html = page(&with(gains).record());
    for part in [told, "1.5", "3.5", "does not check", "typed in the study"] {
        assert!(html.contains(part), "{part}");
    }
}
