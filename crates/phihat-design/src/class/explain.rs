//! Refusal of a class that does not close, with the effects of which less would close it, by trying.

use phihat_certificate::extremes::Extremes as _;

use super::close::Problem;
use super::effect::ClassEffect;
use super::extent::Rates;
use super::refusal::ClassRefusal;
use super::sums::PostureSums;

/// The refusal of a class that does not close over these postures, with what would close it: each effect of the signals
/// is left out in turn, and the largest share of it that closes is bracketed.
pub(super) fn explained(problem: &Problem<'_>, all: &[PostureSums], radius: f64) -> ClassRefusal {
    let worst = |problem: &Problem<'_>| -> Option<f64> {
        let closed = problem.solve(all).ok()?;
        Some(closed.bounds.error.iter().copied().largest())
    };
    let mut closing = Vec::new();
    let mut open = Vec::new();
    let present = |effect: &ClassEffect| problem.counts(*effect);
    for effect in ClassEffect::SIGNALS.into_iter().filter(present) {
        let name = effect.name();
        match worst(&problem.with(effect, 0.0)) {
            Some(error) => {
                let most = largest_share(|share| worst(&problem.with(effect, share)).is_some());
                let up_to = if effect == ClassEffect::Losses || most <= 0.0 {
                    String::new()
                } else {
                    format!(", with {:.0} % of it it closes", 100.0 * most)
                };
                closing.push(format!("without {name}: {:.3} mrad{up_to}", 1e3 * error));
            }
            None => open.push(name),
        }
    }
    let mut words = vec![format!("spectral radius {radius:.3}")];
    words.extend(closing);
    if !open.is_empty() {
        words.push(format!("without {} alone it does not close either", open.join(" or ")));
    }
    let slower: Vec<f64> = SLOWER
        .into_iter()
        .filter(|factor| {
            let pace = problem.pace.times(*factor);
            let rates = Rates::of(problem.scene, &pace);
            worst(&Problem::new(problem.scene, (&pace, &rates), problem.bent)).is_some()
        })
        .collect();
    words.push(match slower.first() {
        Some(factor) => format!("at {factor} of the speed it closes with all of them"),
        None => format!("at {} of the speed it does not close either", SLOWER[SLOWER.len() - 1]),
    });
    ClassRefusal::Open { radius, words: words.join("; ") }
}

/// Factors on the speed that are tried.
const SLOWER: [f64; 3] = [0.75, 0.5, 0.25];

/// Halvings of the bracket around the largest share that closes.
const HALVINGS: u32 = 5;

/// The largest share from 0 to 1 that closes, rounded down to a bracket's end.
fn largest_share(closes: impl Fn(f64) -> bool) -> f64 {
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if closes(middle) { low = middle } else { high = middle }
    }
    low
}
