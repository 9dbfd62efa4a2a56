//! Laws from positions that filter their innovation: their samples against the core's, and what the kernel proves of
//! the core's numbers against the growth of the loop's matrix. Wrong if a filter were left out somewhere, counted
//! twice, or taken for stable where the loop grows.

use core::f64::consts::{PI, TAU};

use phihat::{Form, JointGains, JointState, Measurement, Reference, TorqueSource, VelocitySource};
use phihat_kernel::{Number, Range, frozen};

use super::decay::SignalLayout;
use super::law::LawMatrices;
use super::linear;
use super::response::{CheckedResponse, on_circle};
use super::sample::Loop;
use super::tests::plain;
use crate::dice::CheckDice;
use crate::extremes::Extremes as _;
use crate::{
    FilterSection, InertiaWindow, JointRecord, LoopModel, Matrix, PositionObserver, SampledVarying,
};

const T: f64 = 1e-3;

impl CheckDice {
    pub(super) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * 0.5 * (self.roll() + 1.0)
    }

    pub(super) fn below(&mut self, end: u32) -> u32 {
        let x = self.between(0.0, f64::from(end));
        (0..end).take_while(|i| f64::from(*i) <= x).last().unwrap_or(0)
    }

    /// A section with its poles within a radius: a pair, or two real ones. Weights as of a spring of `stiff` \[1/s²\].
    fn section(&mut self, radius: f64, stiff: f64) -> FilterSection {
        let (size, turn) = (self.between(0.3, radius), self.between(0.0, PI));
        let (sum, product) = if self.roll() > 0.0 {
            (2.0 * size * turn.cos(), size * size)
        } else {
            let other = self.between(-0.5, radius);
            (size + other, size * other)
        };
        let rates = [1.0 - sum + product, 2.0 - sum];
        let weights_per_s2 = [stiff * rates[0] * self.roll(), stiff * self.roll()];
        FilterSection { rates, weights_per_s2 }
    }
}

/// `ℓ` of an observer with its poles at `poles`, from the lowest coefficient of `A_o` up: with `s_j = −T^{2+j}ℓ_{2+j}`
///
/// ```text
/// A_o = w^{m+2} + ℓ_0w^{m+1} + Tℓ_1(w^{m+1} + w^m) + (1 + 3w/2 + w²/2) Σ s_j w^{m−1−j}
/// ```
fn correction(poles: &[f64]) -> Vec<f64> {
    let m = poles.len() - 2;
    let mut wanted = vec![1.0];
    for pole in poles {
        let mut next = vec![0.0; wanted.len() + 1];
        for (k, c) in wanted.iter().enumerate() {
            next[k] += c * (1.0 - pole);
            next[k + 1] += c;
        }
        wanted = next;
    }
    // s by descending j: coefficient k belongs to s_{m−1−k}.
    let mut s = vec![0.0; m + 2];
    for k in 0..m {
        s[m - 1 - k] = wanted[k] - 1.5 * s[m - k] - 0.5 * s[m - k + 1];
    }
    let on_de = wanted[m] - 1.5 * s[0] - 0.5 * s[1];
    let on_e = wanted[m + 1] - on_de - 0.5 * s[0];
    let phi = s[..m].iter().zip(2_u8..).map(|(s, j)| -s / T.powi(i32::from(j)));
    [on_e, on_de / T].into_iter().chain(phi).collect()
}

/// A law with so many sections.
fn law(dice: &mut CheckDice, order: usize, sections: usize, delay_samples: u32) -> JointRecord {
    let w = dice.between(15.0, 60.0);
    let fast = w * dice.between(2.0, 5.0);
    let poles: Vec<f64> =
        (0..order + 2).map(|_| (-fast * dice.between(0.7, 1.4) * T).exp()).collect();
    let stiff = 10.0_f64.powf(dice.between(3.0, 6.0));
    JointRecord {
        name: "joint".into(),
        inertia_kg_m2: dice.between(0.1, 3.0),
        kp_per_s2: w * w,
        kd_per_s: 2.0 * w * dice.between(0.5, 1.2),
        a: vec![],
        observer: Some(PositionObserver {
            correction: correction(&poles),
            share: dice.between(0.2, 1.0),
            delay_samples,
            innovation_filter: (0..sections).map(|_| dice.section(0.95, stiff)).collect(),
        }),
    }
}

/// Every order, number of sections and delay, several times.
pub(super) fn laws(seed: u64, times: usize) -> Vec<JointRecord> {
    let mut dice = CheckDice(seed);
    let mut all = Vec::new();
    for _ in 0..times {
        for order in 1..=3 {
            for sections in 0..=2 {
                for delay in 0..=4 {
                    all.push(law(&mut dice, order, sections, delay));
                }
            }
        }
    }
    all
}

/// The same with a filter.
fn filtered(seed: u64, times: usize) -> impl Iterator<Item = JointRecord> {
    let has =
        |record: &JointRecord| own(record).is_some_and(|own| !own.innovation_filter.is_empty());
    laws(seed, times).into_iter().filter(has)
}

fn own(record: &JointRecord) -> Option<&PositionObserver> {
    record.observer.as_ref()
}

/// A loop that is as the law thinks, or not quite.
fn model(dice: &mut CheckDice, record: &JointRecord) -> LoopModel {
    let told = own(record).map_or(0, |own| own.delay_samples);
    LoopModel {
        period_s: T,
        delay_samples: (told + dice.below(3)).saturating_sub(1),
        torque: if dice.roll() > 0.5 { TorqueSource::Demanded } else { TorqueSource::Applied },
        velocity: VelocitySource::Measured,
        form: Form::Positions,
        drive_bandwidth_hz: (dice.roll() > 0.4).then(|| dice.between(80.0, 400.0)),
        ..plain()
    }
}

/// The core's own law at 1 kHz.
pub(super) fn core(record: &JointRecord) -> Option<JointGains<f64>> {
    own(record)?.gains(record, T).ok()
}

#[test]
fn the_matrices_answer_as_the_core_does() {
    let mut dice = CheckDice(17);
    for (record, model) in laws(5, 1).into_iter().map(|law| (law, positions())).chain(fed_laws()) {
        let record = JointRecord { inertia_kg_m2: 1.0, ..record };
        let (law, own) =
            (record.core_gains_in(&model).unwrap(), LawMatrices::unit(&record, &model));
        let mut state = JointState::new();
        let mut x = vec![0.0; own.len()];
        let mut most = 0.0_f64;
        for k in 0..400 {
            let inputs = [1e-3 * dice.roll(), 1e-2 * dice.roll(), 3.0 * dice.roll()];
            let [q, dq, tau_applied] = inputs;
            let measured = Measurement { q, dq, tau_applied };
            let told = law.update(&mut state, &measured, &Reference::default()).tau;
            // The first sample tells the law where it is.
            if k == 0 {
                let all = state.entries();
                x = own.places.iter().map(|at| all[*at]).collect();
                continue;
            }
            let answer = own.step(&mut x, &[q, dq, tau_applied, 0.0]);
            most = most.max(told.abs());
            let off = (answer - told).abs() / most;
            assert!(off < 1e-9, "{off} {k} {record:?}");
        }
        // A law that has borne a torque for long commands that torque again.
        let mut x = own.bearing.clone();
        let torque = own.step(&mut x, &[0.0, 0.0, 1.0, 0.0]);
        assert!((torque - 1.0).abs() < 1e-9, "{torque} {record:?}");
    }
}

/// A loop of laws from positions.
fn positions() -> LoopModel {
    LoopModel { form: Form::Positions, ..plain() }
}

/// Laws that are fed with velocity, of every form and order.
fn fed_laws() -> Vec<(JointRecord, LoopModel)> {
    let a: [&[f64]; 4] =
        [&[70.0], &[4900.0, 140.0], &[3.4e5, 1.5e4, 210.0], &[2.4e7, 1.4e6, 2.9e4, 280.0]];
    let one = |form: Form, a: &[f64]| {
        let record = JointRecord {
            name: "joint".into(),
            inertia_kg_m2: 1.0,
            kp_per_s2: 400.0,
            kd_per_s: 40.0,
            a: a.to_vec(),
            observer: None,
        };
        (record, LoopModel { form, ..plain() })
    };
    [Form::Observer, Form::Literal].iter().flat_map(|form| a.map(|a| one(*form, a))).collect()
}

/// Spectral radius by squaring: `‖A^{2^k}‖^{1/2^k}`.
fn radius(mut a: Matrix) -> f64 {
    let (mut log, mut power) = (0.0, 1.0);
    for _ in 0..24 {
        let size = a.iter().flatten().map(|x| x.abs()).largest();
        log += size.ln() / power;
        a.iter_mut().flatten().for_each(|x| *x /= size);
        a = product(&a, &a);
        power *= 2.0;
    }
    log.exp()
}

#[test]
fn what_is_proved_stable_is_what_does_not_grow() {
    let mut dice = CheckDice(29);
    let (mut stable, mut grows, mut near) = (0, 0, 0);
    for record in filtered(7, 11) {
        let model = model(&mut dice, &record);
        let mu = 3.0_f64.powf(dice.roll());
        let of = Loop::new(&record, &model, mu);
        let found = radius(SignalLayout::of(&of).matrix(&of));
        if (found - 1.0).abs() < 1e-5 {
            near += 1;
            continue;
        }
        let joint = linear::joint("", &record, &model).unwrap();
        let range = Range::new(mu, mu).unwrap();
        let proved =
            |radius: f64| frozen(&[joint.within(&Number::of(radius).unwrap())], &range).is_ok();
        assert_eq!(proved(1.0), found < 1.0, "{found} {mu} {model:?} {record:?}");
        // All roots are where the matrix has them, those of the filter among them.
        assert!(proved(found * 1.001) && !proved(found * 0.999), "{found} {mu} {record:?}");
        if found < 1.0 { stable += 1 } else { grows += 1 }
    }
    println!("stable {stable}, growing {grows}, near the edge {near}");
    assert!(stable > 100 && grows > 100 && near < 5, "{stable} {grows} {near}");
}

fn product(x: &Matrix, y: &Matrix) -> Matrix {
    let n = y.len();
    let entry = |row: &[f64], j: usize| (0..n).map(|k| row[k] * y[k][j]).sum::<f64>();
    x.iter().map(|row| (0..n).map(|j| entry(row, j)).collect()).collect()
}

/// `Σ (Aᵀ)^k A^k`, by doubling.
fn form(a: &Matrix) -> Matrix {
    let n = a.len();
    let unit = |i: usize, j: usize| f64::from(u8::from(i == j));
    let mut p: Matrix = (0..n).map(|i| (0..n).map(|j| unit(i, j)).collect()).collect();
    let mut power = a.clone();
    for _ in 0..12 {
        let turned = (0..n).map(|i| power.iter().map(|row| row[i]).collect()).collect();
        let more = product(&turned, &product(&p, &power));
        for i in 0..n {
            for j in 0..n {
                p[i][j] += 0.5 * (more[i][j] + more[j][i]);
            }
        }
        power = product(&power, &power);
    }
    p
}

#[test]
fn a_quadratic_form_is_one_of_the_filters_state_too() {
    let mut dice = CheckDice(61);
    let mut seen = 0;
    for record in filtered(13, 1) {
        let model = model(&mut dice, &record);
        let of = Loop::new(&record, &model, 1.1);
        let a = SignalLayout::of(&of).matrix(&of);
        let near = |own: f64, want: f64| (own - want).abs() < 1e-14;
        // Behind q, q̇ and what is expected: x, δ of each section, as angles.
        let known = own(&record).unwrap();
        for (i, section) in known.innovation_filter.iter().enumerate() {
            let (x, [c0, c1]) = (2 + known.correction.len() + 2 * i, section.rates);
            let change = x + 1;
            let others = a[x].iter().map(|entry| entry.abs()).sum::<f64>() - 2.0;
            assert!(near(others, 0.0) && near(a[x][x], 1.0) && near(a[x][change], 1.0));
            assert!(near(a[change][x], -c0) && near(a[change][change], 1.0 - c1));
            // ν is q less what was expected.
            assert!(near(a[change][0], 1.0) && near(a[change][2], -1.0));
        }
        if radius(a.clone()) > 0.97 {
            continue;
        }
        seen += 1;
        let claim = SampledVarying { low: 1.1, high: 1.1, p: form(&a) };
        claim.verify(&record, &model).unwrap();
        let mut other = record.clone();
        other.observer.as_mut().unwrap().innovation_filter.pop();
        let why = claim.verify(&other, &model).unwrap_err();
        assert_eq!(why.inequality, "P = Pᵀ, of the loop's size");
    }
    assert!(seen > 5, "{seen}");
}

/// A law with strong sections in the loop that it is for, and its window by the crossings on both sides of 1.
fn windowed(
    dice: &mut CheckDice,
    record: JointRecord,
) -> Option<(JointRecord, LoopModel, InertiaWindow)> {
    let model =
        LoopModel { form: Form::Positions, delay_samples: own(&record)?.delay_samples, ..plain() };
    let of = Loop::new(&record, &model, 1.0);
    if radius(SignalLayout::of(&of).matrix(&of)) > 1.0 - 1e-4 {
        return None;
    }
    let response = CheckedResponse::of(&linear::joint("", &record, &model).unwrap());
    let crossing = |theta: f64| response.crossing(on_circle(theta));
    let turned = |theta: f64| crossing(theta).im;
    let mut edges = [(0.0, 0.0), (f64::INFINITY, 0.0)];
    let grid: Vec<f64> =
        (0..4000).map(|k| PI * 1e-3_f64.powf(1.0 - f64::from(k) / 3999.0)).collect();
    for pair in grid.windows(2) {
        let (mut a, mut b) = (pair[0], pair[1]);
        if turned(a) * turned(b) > 0.0 {
            continue;
        }
        for _ in 0..80 {
            let middle = 0.5 * (a + b);
            if turned(a) * turned(middle) > 0.0 { a = middle } else { b = middle }
        }
        let mu = crossing(a).re;
        let hz = a / (TAU * T);
        if mu > edges[0].0 && mu < 1.0 {
            edges[0] = (mu, hz);
        } else if mu < edges[1].0 && mu > 1.0 {
            edges[1] = (mu, hz);
        }
    }
    let [(low, low_hz), (high, high_hz)] = edges;
    let ends = dice.between(1e-7, 1e-6);
    let window =
        InertiaWindow { low: low * (1.0 + ends), high: high * (1.0 - ends), low_hz, high_hz };
    (low > 0.0 && high < 1e3).then_some((record, model, window))
}

#[test]
fn a_window_is_refused_for_another_filter() {
    let mut dice = CheckDice(53);
    let (mut windows, mut refused, mut passed) = (0, 0, 0);
    for record in filtered(2, 2) {
        let Some((record, model, window)) = windowed(&mut dice, record) else { continue };
        windows += 1;
        window.verify(&record, &model).unwrap();
        for (at, number) in (0..own(&record).unwrap().innovation_filter.len())
            .flat_map(|at| (0..4).map(move |number| (at, number)))
        {
            // One way for one number, the other way for the next.
            let factor = if number % 2 == 0 { 0.7 } else { 1.3 };
            let mut other = record.clone();
            let section = &mut other.observer.as_mut().unwrap().innovation_filter[at];
            let numbers = section.rates.iter_mut().chain(&mut section.weights_per_s2);
            numbers.skip(number).take(1).for_each(|value| *value *= factor);
            if window.verify(&other, &model).is_err() {
                refused += 1;
                continue;
            }
            // A weight so small that the window is still that, as the samples have it too.
            passed += 1;
            for (edge, inside) in [(window.low, 1.001), (window.high, 0.999)] {
                let grows = |mu: f64| {
                    let of = Loop::new(&other, &model, mu);
                    radius(SignalLayout::of(&of).matrix(&of)) > 1.0
                };
                assert!(!grows(edge * inside) && grows(edge / inside), "{edge} {other:?}");
            }
        }
    }
    println!("{windows} windows: {refused} refused, {passed} passed");
    assert!(windows > 7 && 30 * passed < refused, "{windows} {refused} {passed}");
}
