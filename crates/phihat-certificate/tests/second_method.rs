//! Results of a finder, proved by other means; for every form, velocity source, filter, drive, delay and
//! order.
//! Wrong if both sides had the same mistake.

use crate::loops::{every_model, record};
use phihat_certificate::{
    InertiaWindow, LargestStep, Margins, ReadingError, ReferenceError, SampledPeaks,
    SampledVarying, TorqueNoise, VaryingWindow,
};
use phihat_design::prelude::*;

#[test]
fn every_claim_about_the_sampled_loop_is_proved_by_other_means() {
    let mut worst = Vec::new();
    for (index, model) in every_model(1e-3).into_iter().enumerate() {
        // One in six, or one in three: every order with every setting.
        let of = if std::env::var_os("PHIHAT_ALL").is_some() { 3 } else { 6 };
        for order in (1..=4).filter(|order| (index + order) % of == 0) {
            let gains = record(order, 30.0);
            let Ok(window) = InertiaWindow::find(&gains, &model) else { continue };
            let range = (window.low.max(0.4) * 1.2, window.high.min(4.0) / 1.2);
            if range.0 >= range.1 {
                continue;
            }
            let mut check = |what: &str, found: Result<(), phihat_certificate::Refutation>| {
                if let Err(why) = found {
                    worst.push(format!("{what}: {why} m {order} {model:?}"));
                }
            };
            check("window", window.verify(&gains, &model));
            let margins = Margins::find(&gains, &model, range).unwrap();
            check("margins", margins.verify(&gains, &model));
            let peaks = SampledPeaks::find(&gains, &model, range, 3).unwrap();
            check("peaks", peaks.verify(&gains, &model));
            let reading = ReadingError::find(&gains, &model, range, 3).unwrap();
            check("reading", reading.verify(&gains, &model));
            for fed in [true, false] {
                let reference = ReferenceError::find(&gains, &model, fed, range, 3).unwrap();
                check("reference", reference.verify(&gains, &model));
            }
            let noise = TorqueNoise::find(&gains, &model, 1e-5, range, 3).unwrap();
            check("noise", noise.verify(&gains, &model));
            let limits = (Some(40.0), Some(900.0));
            let step = LargestStep::find(&gains, &model, limits, range, 3).unwrap();
            check("step", step.verify(&gains, &model, limits));
            if let Ok(varying) = VaryingWindow::find(&gains, range) {
                check("varying", varying.verify(&gains));
            }
            if let Ok(varying) = SampledVarying::find(&gains, &model, (range.0, range.0 * 1.2)) {
                check("sampled varying", varying.verify(&gains, &model));
            }
        }
    }
    for line in &worst {
        println!("{line}");
    }
    assert!(worst.is_empty(), "{}", worst.len());
}
