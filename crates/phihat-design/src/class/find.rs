//! The search for the postures that set a class bound, and its document.

use phihat_certificate::extremes::Extremes as _;
use phihat_certificate::{ClassBound, ClassPart, ClassWitness, Gains, TubePayloadSet};
use phihat_model::evenly;
use phihat_study::Study;

use super::close::{Closed, INFLATED, Problem};
use super::explain::explained;
use super::extent::{Bent, ClassPaceLimits, Rates};
use super::faster::paces;
use super::refusal::ClassRefusal;
use super::scene::ClassScene;
use super::sums::PostureSums;
use phihat_certificate::parallel::{both, parallel, threads};

/// Postures of the first round, corners and inner points, payloads in turn.
const FIRST: u32 = 48;

/// Postures of the first round where a search for gains asks.
const FEW: u32 = 12;

/// Moves of the rounds that follow, as a share of the box's width.
const MOVES: [f64; 3] = [1.0, 0.35, 0.12];

/// A posture that raises a joint's error by less is not taken.
const WORTH: f64 = 1.001;

/// Digits of a bound: rounded up.
const DIGITS: f64 = 1e5;

/// Bounds on the error of every motion of a study's class, for its gains.
///
/// # Method
///
/// docs/theory/class.md: sums over the responses of the loop frozen at a posture, the least solution of (CM5) over
/// postures, which are searched: corners and inner points of the box with every payload, then moves of one joint from
/// those that set the error.
///
/// # Errors
///
/// [`ClassRefusal`]: the theorem does not cover the study, the loop is not stable at a posture, or the class does not
/// close, with its spectral radius.
pub fn class_bound(study: &Study, gains: &Gains) -> Result<ClassBound, ClassRefusal> {
    bound(study, gains, &Effort { first: FIRST, moves: &MOVES, paces: true })
}

/// The same over a few postures, without a search that goes on: for a search for gains, not to be claimed.
///
/// # Errors
///
/// As [`class_bound`].
pub fn quick_class_bound(study: &Study, gains: &Gains) -> Result<ClassBound, ClassRefusal> {
    bound(study, gains, &Effort { first: FEW, moves: &[], paces: false })
}

/// Extent of a search.
struct Effort {
    /// Postures of the first round.
    first: u32,
    moves: &'static [f64],
    paces: bool,
}

fn bound(study: &Study, gains: &Gains, effort: &Effort) -> Result<ClassBound, ClassRefusal> {
    let scene = ClassScene::new(study, gains)?;
    let pace = ClassPaceLimits::of(scene.class);
    let ((rates, bent), all) = both(
        threads(),
        || (Rates::of(&scene, &pace), Bent::of(&scene)),
        || first(&scene, effort.first),
    );
    let mut all = all?;
    let problem = Problem::new(&scene, (&pace, &rates), &bent);
    // In a search for gains nothing is tried.
    let solved = |all: &[PostureSums]| {
        problem.solve(all).map_err(|radius| {
            if effort.paces { explained(&problem, all, radius) } else { ClassRefusal::open(radius) }
        })
    };
    let mut closed = solved(&all)?;
    for share in effort.moves {
        let more = moved(&scene, &all, &closed, *share)?;
        let raised = |own: &PostureSums| {
            all.first().is_some_and(|first| {
                INFLATED * problem.compared(&closed, first, own).into_iter().largest() > WORTH
            })
        };
        let taken: Vec<PostureSums> = more.into_iter().filter(raised).collect();
        if !taken.is_empty() {
            all.extend(taken);
            closed = solved(&all)?;
        }
    }
    let mut found = document(study, (&scene, &pace), (&rates, &bent), (&all, &closed));
    if effort.paces {
        found.paces = paces(&scene, &pace, (&bent, &all));
    }
    found.parts = problem.parts(&all, &closed).iter().map(shown).collect();
    Ok(found)
}

/// The first postures.
fn first(scene: &ClassScene<'_>, count: u32) -> Result<Vec<PostureSums>, ClassRefusal> {
    let (ends, cases) = (scene.ends(), scene.cases.len());
    let middle: Vec<f64> = ends.iter().map(|(low, high)| 0.5 * (low + high)).collect();
    let mut places: Vec<(usize, Vec<f64>)> =
        (0..cases).map(|case| (case, middle.clone())).collect();
    for (k, mut q) in evenly(&ends, count).enumerate() {
        if k % 2 == 0 {
            for (q, (low, high)) in q.iter_mut().zip(&ends) {
                *q = if *q < 0.5 * (low + high) { *low } else { *high };
            }
        }
        places.push(((k / 2) % cases.max(1), q));
    }
    summed(scene, &places)
}

fn summed(
    scene: &ClassScene<'_>,
    places: &[(usize, Vec<f64>)],
) -> Result<Vec<PostureSums>, ClassRefusal> {
    let list: Vec<usize> = (0..places.len()).collect();
    let made = parallel(&list, threads(), |at| {
        let (case, q) = &places[at];
        PostureSums::at(scene, *case, q)
    });
    made.into_iter().collect()
}

/// Sums at postures one move away from those that set an error, and there with the other payloads.
fn moved(
    scene: &ClassScene<'_>,
    all: &[PostureSums],
    closed: &Closed,
    share: f64,
) -> Result<Vec<PostureSums>, ClassRefusal> {
    let mut places: Vec<(usize, Vec<f64>)> = Vec::new();
    let mut setting = closed.at.clone();
    setting.sort_unstable();
    setting.dedup();
    for own in setting.iter().filter_map(|at| all.get(*at)) {
        for (joint, (low, high)) in scene.ends().into_iter().enumerate() {
            for way in [1.0, -1.0] {
                let mut q = own.q.clone();
                q[joint] = (q[joint] + way * share * (high - low)).clamp(low, high);
                places.push((own.case, q));
            }
        }
        places.extend((0..scene.cases.len()).map(|case| (case, own.q.clone())));
    }
    let known = |place: &(usize, Vec<f64>)| all.iter().any(|s| s.case == place.0 && s.q == place.1);
    let mut fresh: Vec<(usize, Vec<f64>)> = Vec::new();
    for place in places {
        if !known(&place) && !fresh.contains(&place) {
            fresh.push(place);
        }
    }
    summed(scene, &fresh)
}

/// Rounded up.
fn written(list: &[f64]) -> Vec<f64> {
    let up = |x: &f64| {
        let text = format!("{:.5e}", x * (1.0 + 1.0 / DIGITS));
        text.parse().unwrap_or(f64::INFINITY)
    };
    list.iter().map(up).collect()
}

/// A part with as many digits as are of use.
fn shown(part: &ClassPart) -> ClassPart {
    ClassPart {
        name: part.name.clone(),
        error_bound_rad: written(&part.error_bound_rad),
        torque_step_nm: written(&part.torque_step_nm),
    }
}

fn document(
    study: &Study,
    (scene, pace): (&ClassScene<'_>, &ClassPaceLimits),
    (rates, bent): (&Rates, &Bent),
    (all, closed): (&[PostureSums], &Closed),
) -> ClassBound {
    let set = &study.design.payload;
    let names = &study.robot.joints;
    let mut setting = closed.at.clone();
    setting.sort_unstable();
    setting.dedup();
    let witness = |at: usize| {
        let sums = all.get(at)?;
        let of = closed.at.iter().enumerate().filter(|(_, own)| **own == at);
        Some(ClassWitness {
            q_rad: sums.q.clone(),
            payload: scene.cases.get(sums.case)?.payload.clone(),
            joints: of.map(|(i, _)| names[i].name.clone()).collect(),
        })
    };
    ClassBound {
        box_rad: (scene.class.low.clone(), scene.class.high.clone()),
        speed_max_rad_s: pace.v.clone(),
        acceleration_max_rad_s2: pace.a.clone(),
        jerk_max_rad_s3: pace.j.clone(),
        payload: TubePayloadSet {
            frame: set.frame.clone(),
            mass_kg: set.mass,
            com_m: set.com,
            gyration_m: set.gyration,
        },
        force_nm: scene.dry.clone(),
        start_nm: if scene.before > 0.0 { scene.start.clone() } else { Vec::new() },
        start_s: scene.before,
        reading_rad: scene.reading.clone(),
        signals: Some(scene.signals.clone()).filter(|own| !own.is_perfect()),
        error_bound_rad: written(&closed.bounds.error),
        velocity_error_bound_rad_s: written(&closed.bounds.velocity),
        torque_step_nm: written(&closed.step),
        torque_nm: written(&closed.torque),
        frozen_error_bound_rad: written(&closed.frozen),
        spectral_radius: closed.radius,
        postures: u32::try_from(all.len()).unwrap_or(u32::MAX),
        points: rates.points,
        source: format!(
            "searched: corners and inner points of the box with {} payloads, moved on from those that set an error; \
             second derivatives at {} postures",
            scene.cases.len(),
            bent.postures
        ),
        witnesses: setting.into_iter().filter_map(witness).collect(),
        paces: Vec::new(),
        parts: Vec::new(),
    }
}
