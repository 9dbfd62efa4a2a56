//! Proved ranges of inertia, against closed forms of planar chains.
//!
//! Wrong if a proved end is not outside of the closed form's, or further out than it is sought.

use std::fmt::Write as _;

use phihat_certificate::{ArmBasis, ArmInertia, ProvedEnd, RangeProof, RangeUnproved};
use phihat_study::Study;

/// Mass \[kg\], distance of its centre, length \[m\], inertia about the centre and of the rotor \[kg·m²\] of each link.
const LINK: [f64; 5] = [1.0, 0.15, 0.3, 8e-3, 0.1];

/// Planar chain of equal links with joints that have no ends.
fn chain(joints: usize, design: &str) -> Study {
    let [mass, centre, length, inertia, rotor] = LINK;
    let mut urdf = String::from("<robot name=\"chain\"><link name=\"l0\"/>");
    for i in 0..joints {
        let (next, x) = (i + 1, if i == 0 { 0.0 } else { length });
        let _ = write!(
            urdf,
            "<link name=\"l{next}\"><inertial><origin xyz=\"{centre} 0 0\"/><mass value=\"{mass}\"/><inertia \
             ixx=\"1e-4\" iyy=\"{inertia}\" izz=\"{inertia}\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/></inertial></link>\
             <joint name=\"j{next}\" type=\"continuous\"><parent link=\"l{i}\"/><child link=\"l{next}\"/>\
             <origin xyz=\"{x} 0 0\"/><axis xyz=\"0 0 1\"/></joint>"
        );
    }
    urdf += "</robot>";
    let folder = std::env::temp_dir().join(format!("phihat_range_{}_{joints}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    std::fs::write(folder.join("chain.urdf"), urdf).unwrap();
    let text = format!(
        "duration_s = 2.0\n[robot]\nfile = \"chain.urdf\"\narmature_kg_m2 = {rotor}\n[spec]\nerror_bound_rad = \
         1e-3\n[design]\n{design}\n[loop]\ntorque_max_nm = \"none\"\n[reference]\nkind = \"hold\"\nq_rad = 0.3\n"
    );
    let study = Study::from_text(&text, "range.toml", &folder);
    let study = study.unwrap_or_else(|e| panic!("{}", e.render()));
    std::fs::remove_dir_all(&folder).unwrap();
    study
}

fn stated(joints: usize, (low, high): (f64, f64)) -> ArmInertia {
    ArmInertia {
        basis: ArmBasis::Postures,
        source: "closed form".to_owned(),
        nominal_kg_m2: vec![1.0; joints],
        low,
        high,
        searched: None,
    }
}

/// Eigenvalues of a chain of two links: `M` by the law of cosines.
fn two_links(q: f64) -> (f64, f64) {
    let [mass, centre, length, inertia, rotor] = LINK;
    let (b, d) = (mass * length * centre * q.cos(), mass * centre * centre + inertia);
    let (first, both) = (2.0 * d + mass * length * length + 2.0 * b + rotor, d + b);
    let (middle, half) = (0.5 * (first + d + rotor), 0.5 * (first - d - rotor));
    let apart = half.hypot(both);
    (middle - apart, middle + apart)
}

#[test]
fn two_links_are_proved_within_half_a_percent() {
    let ends = (0..20_000).map(|k| two_links(f64::from(k) * 1e-4 * core::f64::consts::PI));
    let (low, high) =
        ends.fold((f64::INFINITY, 0.0_f64), |(low, high), (a, b)| (low.min(a), high.max(b)));
    let proof = RangeProof::of(&chain(2, ""), &stated(2, (low, high)), &mut |_| true).unwrap();
    assert!(proof.step.is_none() && proof.outside.is_none(), "{proof:?}");
    assert!(proof.low <= low && low < 1.00501 * proof.low, "{low} {proof:?}");
    assert!(proof.high >= high && proof.high < 1.00501 * high, "{high} {proof:?}");
    println!("two links: {low} … {high}, {proof:?}");
    for (narrow, end) in
        [((1.01 * low, high), ProvedEnd::Low), ((low, high / 1.01), ProvedEnd::High)]
    {
        let proof = RangeProof::of(&chain(2, ""), &stated(2, narrow), &mut |_| true).unwrap();
        let outside = proof.outside.unwrap();
        let (a, b) = two_links(outside.q[1]);
        let value = if end == ProvedEnd::Low { a } else { b };
        assert!(
            outside.end == end && (value / outside.eigenvalue - 1.0).abs() < 1e-9,
            "{outside:?}"
        );
    }
}

/// All entries of `M` are largest where the chain is stretched, and positive: so is its largest eigenvalue.
#[test]
fn a_chain_of_four_is_largest_stretched() {
    let [mass, centre, length, inertia, rotor] = LINK;
    let n = 4;
    let entry = |i: usize, j: usize| -> f64 {
        let arm = |k: usize, i: usize| (k - i) as f64 * length + centre;
        let sum: f64 = (i.max(j)..n).map(|k| mass * arm(k, i) * arm(k, j) + inertia).sum();
        sum + if i == j { rotor } else { 0.0 }
    };
    let mut v = vec![1.0; n];
    let mut most = 0.0;
    for _ in 0..200 {
        let next: Vec<f64> = (0..n).map(|i| (0..n).map(|j| entry(i, j) * v[j]).sum()).collect();
        most = next.iter().map(|x| x * x).sum::<f64>().sqrt();
        v = next.iter().map(|x| x / most).collect();
    }
    let study = chain(n, "");
    // The rotor alone is below all.
    let proof = RangeProof::of(&study, &stated(n, (rotor, most)), &mut |_| true).unwrap();
    assert!(proof.step.is_none() && proof.outside.is_none(), "{proof:?}");
    assert!(proof.high >= most && proof.high < 1.00501 * most, "{most} {proof:?}");
    println!("stretched chain of four: {most}, {proof:?}");
}

#[test]
fn what_is_stopped_says_how_far_it_came_and_what_cannot_be_proved_says_why() {
    let study = chain(4, "");
    let wide = stated(4, (0.1, 10.0));
    let proof = RangeProof::of(&study, &wide, &mut |proof| proof.cells < 20).unwrap();
    let step = proof.step.unwrap();
    assert!(step.factor > 1.0 && (0.0..1.0).contains(&step.done), "{proof:?}");
    let few = RangeProof::of(&study, &stated(3, (0.1, 10.0)), &mut |_| true).unwrap_err();
    assert_eq!(few, RangeUnproved::Joints { nominal: 3, joints: 4 });
    let typed = "inertia_low_kg_m2 = 0.1\ninertia_high_kg_m2 = 3.0";
    let typed = RangeProof::of(&chain(2, typed), &stated(2, (0.1, 3.0)), &mut |_| true);
    assert_eq!(typed.unwrap_err(), RangeUnproved::NotOfARobot);
}
