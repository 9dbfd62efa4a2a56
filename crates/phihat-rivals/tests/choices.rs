//! Free choices of the inputs of laws. It fails if default choices change a bit of any law, if a choice does
//! something else than passing other samples or another inertia, or if a law that uses something has no
//! choice of it.

use crate::support::{Bench, PERIOD};
use phihat_rivals::{All, Chosen, Entry, RIVALS, Running, SensedChoice, Supply, rival};

const SENSED: SensedChoice = SensedChoice { rate_hz: 1e3, velocity_filter_hz: Some(100.0) };

fn names(entry: &Entry) -> Vec<&'static str> {
    entry.choices(SENSED).0.iter().map(|scalar| scalar.name).collect()
}

/// A sample of an arm of three joints: position, velocity, torque that acted, torque commanded.
type Sample = [[f64; 3]; 4];

fn sample(k: u32) -> Sample {
    let part = |a: f64| core::array::from_fn(|i| (a * f64::from(k) + 1.3 * i as f64).sin());
    [0.011, 0.07, 0.13, 0.19].map(part)
}

/// The torques that a law answers with to samples.
fn answers(law: &mut dyn Running, samples: impl Iterator<Item = Sample>) -> Vec<[f64; 3]> {
    let zero = [0.0; 3];
    let answer = |[q, dq, tau, commanded]: Sample| {
        let mut answer = zero;
        let all = All {
            q: &q,
            dq: &dq,
            tau: &tau,
            commanded: &commanded,
            clipped: &[false; 3],
            q_d: &[0.1, 0.2, -0.1],
            dq_d: &[0.2, -0.1, 0.1],
            ddq_d: &zero,
            ddq_d_acting: &zero,
        };
        law.update(&all, &mut answer);
        answer
    };
    samples.map(answer).collect()
}

fn built(entry: &Entry, supply: &Supply, chosen: &Chosen) -> Box<dyn Running> {
    let bench = Bench::arm("planar3r");
    entry.build_as_chosen(&bench.published(entry), supply, chosen).unwrap()
}

/// A law that has `M̄` in it may scale it; one that takes a torque may take the other one; all may filter,
/// one that takes positions alone like any other. Nothing is offered twice, and nothing to designed gains.
#[test]
fn what_a_law_uses_is_free_for_it() {
    for (id, free) in [
        ("pd", &["sensor_filter"][..]),
        ("computed-torque", &["sensor_filter"]),
        ("industrial-pid", &["inertia_share", "sensor_filter"]),
        ("adrc", &["inertia_share", "sensor_filter", "torque_fed"]),
        ("proposed-1", &["inertia_share", "sensor_filter", "torque_fed"]),
        ("proposed-positions-1", &["inertia_share", "sensor_filter", "torque_fed"]),
        // These have a factor of their own.
        ("time-delay", &["sensor_filter", "torque_fed"]),
        ("indi", &["sensor_filter", "torque_fed"]),
        ("proposed-designed", &[]),
    ] {
        assert_eq!(names(rival(id).unwrap()), free, "{id}");
    }
    for entry in RIVALS {
        let (free, wide) = entry.choices(SENSED);
        let has = |name: &str| {
            let own = entry.scalars.iter().filter(|scalar| scalar.name == name);
            own.chain(free.iter().filter(|scalar| scalar.name == name)).count()
        };
        let (needs, open) = (entry.needs, usize::from(!entry.needs.designed));
        assert_eq!(has("sensor_filter"), open, "{}", entry.card.id);
        assert_eq!(has("inertia_share"), open * usize::from(needs.inertia), "{}", entry.card.id);
        let torque = usize::from(needs.torque || needs.commanded);
        assert_eq!(has("torque_fed"), open * torque, "{}", entry.card.id);
        assert!(free.iter().all(|s| s.low < s.default && s.default < s.high), "{}", entry.card.id);
        assert_eq!(wide, usize::from(free.iter().any(|s| s.name == "inertia_share")));
        for bad in [vec![1.0; free.len() + 1], vec![-1.0; free.len().max(1)]] {
            assert!(entry.chosen(&bad).is_err(), "{}", entry.card.id);
        }
    }
}

/// The default choices are what every law is handed without one, bit for bit.
#[test]
fn default_choices_leave_every_law_as_it_is() {
    let bench = Bench::arm("planar3r");
    for entry in RIVALS {
        let Ok(mut plain) = entry.build_with_friction(&bench.published(entry), &bench.supply)
        else {
            continue;
        };
        let values: Vec<f64> =
            entry.choices(SENSED).0.iter().map(|scalar| scalar.default).collect();
        let mut chosen = built(entry, &bench.supply, &entry.chosen(&values).unwrap());
        let bits =
            |all: Vec<[f64; 3]>| all.concat().iter().map(|t| t.to_bits()).collect::<Vec<_>>();
        let plain = bits(answers(&mut *plain, (0..40).map(sample)));
        assert_eq!(plain, bits(answers(&mut *chosen, (0..40).map(sample))), "{}", entry.card.id);
    }
}

/// The other torque is that of a law whose samples have the two exchanged; a filtered position is one that
/// was filtered before, by the recursion `y ← y + (1 − e^{−2π f T})(q − y)`; a factor on `M̄` is that of an
/// arm with such inertias.
#[test]
fn choices_are_other_samples_and_another_inertia() {
    let bench = Bench::arm("planar3r");
    let same = |what: &str, one: Vec<[f64; 3]>, other: Vec<[f64; 3]>| {
        for (one, other) in one.concat().into_iter().zip(other.concat()) {
            assert!((one - other).abs() <= 1e-9 * (1.0 + other.abs()), "{what}: {one} {other}");
        }
    };
    for (id, commanded) in [("time-delay", false), ("indi", true), ("adrc", true)] {
        let entry = rival(id).unwrap();
        let chosen = Chosen { commanded: Some(commanded), ..Chosen::default() };
        let found = answers(&mut *built(entry, &bench.supply, &chosen), (0..40).map(sample));
        let exchanged = |k: u32| {
            let [q, dq, tau, commanded] = sample(k);
            [q, dq, commanded, tau]
        };
        let plain = || built(entry, &bench.supply, &Chosen::default());
        same(id, found.clone(), answers(&mut *plain(), (0..40).map(exchanged)));
        assert!(found != answers(&mut *plain(), (0..40).map(sample)), "{id}");
    }
    let adrc = rival("adrc").unwrap();
    let chosen = Chosen { filter_hz: Some(50.0), ..Chosen::default() };
    let found = answers(&mut *built(adrc, &bench.supply, &chosen), (0..40).map(sample));
    let share = 1.0 - (-2.0 * core::f64::consts::PI * 50.0 * PERIOD).exp();
    let mut y = sample(0)[0];
    let filtered = (0..40).map(|k| {
        let [q, dq, tau, commanded] = sample(k);
        y = core::array::from_fn(|i| y[i] + share * (q[i] - y[i]));
        [y, dq, tau, commanded]
    });
    same("adrc", found, answers(&mut *built(adrc, &bench.supply, &Chosen::default()), filtered));
    // The velocity's filter is the sensors'.
    assert_eq!(chosen.velocity_filter_hz(1e3), Some(50.0));
    let none = Chosen { filter_hz: Some(500.0), ..Chosen::default() };
    assert_eq!(none.velocity_filter_hz(1e3), None);
    for id in ["proposed-1", "adrc", "disturbance-observer"] {
        let entry = rival(id).unwrap();
        let chosen = Chosen { inertia_share: Some(1.7), ..Chosen::default() };
        let mut heavier = bench.supply.clone();
        heavier.inertia.iter_mut().for_each(|inertia| *inertia *= 1.7);
        let found = answers(&mut *built(entry, &bench.supply, &chosen), (0..40).map(sample));
        let plain = answers(&mut *built(entry, &heavier, &Chosen::default()), (0..40).map(sample));
        same(id, found, plain);
    }
}
