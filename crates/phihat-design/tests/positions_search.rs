//! The search for laws from positions.
//!
//! Wrong if laws for a share of the noise depend on how large the error is that all joints are allowed.

use std::path::Path;

use phihat_design::{Arm, PositionSearch};
use phihat_sim::Demand;
use phihat_study::Study;
use phihat_synthesis::phi_along;

/// The planar arm, with this error allowed on every joint.
fn study(error: &str) -> Study {
    let text = format!(
        "duration_s = 4.0\n[robot]\nname = \"planar3r\"\n[spec]\nerror_bound_rad = {error}\n[design]\npayload_max_kg = \
         0.3\n[loop]\nform = \"positions\"\ndelay_samples = 1\n[sensor]\nencoder_bits = 18\n\
         [reference]\nkind = \"sines\"\ncenter_rad = [0.3, 0.5, 0.5]\n[[reference.sine]]\namplitude_rad = 0.2\n\
         frequency_hz = 0.3\nphase_rad = 0.0\n"
    );
    let read = Study::from_text(&text, "search.toml", Path::new(""));
    read.unwrap_or_else(|e| panic!("{}", e.render()))
}

#[test]
fn a_nominal_inertia_is_chosen_alike_for_small_errors_and_for_large_ones() {
    let laws = |error: &str| {
        let study = study(error);
        let demand = Demand::along(&study).unwrap();
        let phi = |joint: usize, inertia: f64| phi_along(&demand, joint, inertia);
        let arm = Arm::of(&study).unwrap();
        let mut search = PositionSearch::with_least_error(&study, &arm, &phi).unwrap();
        search.laws(&[0.6; 3]).unwrap().0.joints
    };
    let small = laws("1e-6");
    for larger in ["4e-4", "1e-1"] {
        assert_eq!(laws(larger), small, "{larger}");
    }
}
