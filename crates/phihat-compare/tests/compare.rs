//! The comparison: the same answer however it is run, the same terms for everybody, and a judge that is not fooled.

use std::fs;
use std::path::{Path, PathBuf};

use phihat_campaign::Journal;
use phihat_compare::{
    Comparison, ComparisonExtent, ComparisonPlan, Figures, GainsKind, LawCell, Mark, RunOutcome,
};
use phihat_model::Workspace;
use phihat_rivals::{
    Card, DeclaredArm, Entry, Grade, MeasuredMotion, Nothing, Rival, RivalRefusal, Scalar, Tuning,
    Velocity,
};

/// Behaviour of a test's rival.
trait Way: core::fmt::Debug + Send + 'static {
    const ID: &'static str;
    fn torque(t: f64, e: f64, de: f64, unit: f64, gain: f64) -> f64;
    fn bound(_: &[f64], _: f64, _: &DeclaredArm) -> Option<Vec<f64>> {
        None
    }
}

#[derive(Debug)]
struct Of<W> {
    units: Vec<f64>,
    gain: f64,
    t: f64,
    way: core::marker::PhantomData<W>,
}

impl<W: Way> Rival for Of<W> {
    const CARD: Card = Card {
        id: W::ID,
        title: W::ID,
        reference: "",
        source: "",
        grade: Grade::A,
        caveat: "",
        law: "",
        printed: None,
    };
    const SCALARS: &'static [Scalar] = &[Scalar {
        name: "gain",
        unit: "rad/s",
        meaning: "",
        default: 100.0,
        low: 50.0,
        high: 200.0,
    }];
    type Sees<'a> = MeasuredMotion<'a>;
    type Wants<'a> = Velocity<'a>;
    type Knows = Nothing;

    fn new(tuning: &Tuning, _: Nothing) -> Result<Self, RivalRefusal> {
        let [gain] = tuning.values()?;
        let way = core::marker::PhantomData;
        Ok(Self { units: tuning.units().to_vec(), gain, t: 0.0, way })
    }

    fn update(
        &mut self,
        sees: MeasuredMotion<'_>,
        wants: Velocity<'_>,
        _: &[bool],
        tau: &mut [f64],
    ) {
        for (i, tau) in tau.iter_mut().enumerate() {
            let (e, de) = (sees.q[i] - wants.q[i], sees.dq[i] - wants.dq[i]);
            *tau = W::torque(self.t, e, de, self.units[i], self.gain);
        }
        self.t += 1e-3;
    }

    fn states(&self) -> usize {
        1
    }

    fn bound(tuning: &Tuning, arm: &DeclaredArm) -> Option<Vec<f64>> {
        let [gain] = tuning.values().ok()?;
        W::bound(tuning.units(), gain, arm)
    }
}

/// A stiff spring and damper; at rest the error is the load over the stiffness, and that is its bound.
#[derive(Debug)]
struct Spring;
impl Way for Spring {
    const ID: &'static str = "spring";
    fn torque(_: f64, e: f64, de: f64, unit: f64, gain: f64) -> f64 {
        -unit * (gain * gain * e + 2.0 * gain * de)
    }
    fn bound(units: &[f64], gain: f64, arm: &DeclaredArm) -> Option<Vec<f64>> {
        Some(arm.phi_max.iter().zip(units).map(|(phi, u)| phi / (u * gain * gain)).collect())
    }
}

/// Says nothing but zero.
#[derive(Debug)]
struct Still;
impl Way for Still {
    const ID: &'static str = "still";
    fn torque(_: f64, _: f64, _: f64, _: f64, _: f64) -> f64 {
        0.0
    }
}

/// A good law, but for one sample that is no number, at 1 s.
#[derive(Debug)]
struct Broken;
impl Way for Broken {
    const ID: &'static str = "broken";
    fn torque(t: f64, e: f64, de: f64, unit: f64, gain: f64) -> f64 {
        let now = (t - 1.0).abs() < 5e-4;
        if now { f64::NAN } else { Spring::torque(t, e, de, unit, gain) }
    }
}

/// Drives the arm away, as hard as it may.
#[derive(Debug)]
struct Runaway;
impl Way for Runaway {
    const ID: &'static str = "runaway";
    fn torque(_: f64, e: f64, de: f64, unit: f64, gain: f64) -> f64 {
        unit * gain * gain * (e + 1e-3) + unit * gain * de
    }
}

static SPRING: Entry = Entry::of::<Of<Spring>>();
static STILL: Entry = Entry::of::<Of<Still>>();
static BROKEN: Entry = Entry::of::<Of<Broken>>();
static RUNAWAY: Entry = Entry::of::<Of<Runaway>>();

const MOVING: &str = "kind = \"sines\"\ncenter = \"ready\"\nfade_in_s = 1.0\n[[reference.sine]]\n\
    amplitude_rad = 0.3\nfrequency_hz = 0.4\n";

/// The folder of this crate's tests.
fn folder() -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(env!("CARGO_PKG_NAME"));
    fs::create_dir_all(&folder).unwrap();
    folder
}

fn study(name: &str, extra: &str, reference: &str) -> PathBuf {
    let path = folder().join(format!("{name}.toml"));
    let text = format!(
        "duration_s = 3.0\n[robot]\nname = \"planar3r\"\n[spec]\nsettle_s = 1.5\nerror_bound_rad = 1e-2\n\
         [design]\npayload_max_kg = 0.3\n[loop]\nform = \"observer\"\nrate_hz = 1000.0\ndelay_samples = 1\n\
         [sensor]\nencoder_bits = 20\nvelocity = \"differenced\"\nvelocity_filter_hz = 100.0\n\
         {extra}[reference]\n{reference}"
    );
    fs::write(&path, text).unwrap();
    path
}

fn short(worlds: &[&str]) -> ComparisonExtent {
    ComparisonExtent {
        worlds: worlds.iter().map(|w| (*w).to_owned()).collect(),
        tuning_runs: 4,
        widenings: 0,
        training_s: 1.2,
        training_settle_s: 0.8,
        draws: 2,
        scored_max_s: 1.0,
        ..ComparisonExtent::quick()
    }
}

fn journal(name: &str) -> PathBuf {
    let path = folder().join(format!("{name}.jsonl"));
    let _ = fs::remove_file(&path);
    path
}

fn done(plan: &ComparisonPlan, journal: &Path, threads: usize) -> Comparison {
    plan.run(&mut Journal::open(journal).unwrap(), threads, |_| ()).unwrap()
}

fn tuned<'c>(comparison: &'c Comparison, rival: &str, world: &str) -> &'c LawCell {
    let row = comparison.rows.iter().find(|row| row.rival == rival).unwrap();
    row.cell(world, GainsKind::Tuned).unwrap()
}

/// One thread, two threads, and an interruption after half of the lines, in the middle of one: the same bytes.
#[test]
fn the_answer_does_not_depend_on_how_it_was_run() {
    let study = study("same", "", MOVING);
    let mut extent = short(&["exact", "delay"]);
    extent.only = vec!["pd".to_owned(), "proposed-2".to_owned()];
    let plan = ComparisonPlan::new(&[study], extent).unwrap();
    let text = |c: &Comparison| serde_json::to_string(c).unwrap();
    let first = journal("same-1");
    let one = text(&done(&plan, &first, 1));
    assert_eq!(one, text(&done(&plan, &journal("same-2"), 2)));
    let bytes = fs::read(&first).unwrap();
    fs::write(&first, &bytes[..bytes.len() / 2]).unwrap();
    assert_eq!(one, text(&done(&plan, &first, 2)));
    let back: Comparison = serde_json::from_str(&one).unwrap();
    assert_eq!(text(&back), one);
}

/// The same number of evaluations for every rival of the list, whatever its dimension; what does not apply says why;
/// and with exact sensors every law that applies follows on both arms, tuned or not.
#[test]
fn everybody_is_tuned_with_the_same_budget_and_follows_with_exact_sensors() {
    let studies = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../studies");
    let studies = ["table1.toml", "table1_panda.toml"].map(|name| studies.join(name));
    let plan = ComparisonPlan::new(&studies, short(&["exact"])).unwrap();
    let comparison = done(&plan, &journal("fair"), 2);
    assert_eq!(comparison.rows.len(), 2 * plan.rivals.len());
    let mut refused = Vec::new();
    for row in &comparison.rows {
        let (name, record) = (&row.rival, comparison.rival(&row.rival).unwrap());
        let Some(tuning) = &row.tuning else {
            assert!(!row.refused.as_ref().unwrap().is_empty(), "{name}");
            refused.push((row.arm.as_str(), name.as_str()));
            continue;
        };
        assert_eq!(tuning.runs, if record.scalars.is_empty() { 1 } else { 4 }, "{name}");
        assert_eq!((tuning.rounds, tuning.ranges.len()), (1, record.scalars.len()), "{name}");
        assert!(tuning.cost_tuned <= tuning.cost_default, "{name}");
        for (value, scalar) in tuning.tuned.iter().zip(&record.scalars) {
            assert!((scalar.range[0]..=scalar.range[1]).contains(value), "{name}");
        }
        for gains in [GainsKind::Default, GainsKind::Tuned] {
            let outcome = &row.cell("exact", gains).unwrap().outcome;
            assert!(outcome.followed(), "{} {name} {gains:?}: {outcome:?}", row.arm);
        }
    }
    assert_eq!(refused, [("table1_panda", "task-space")]);
}

/// A law that says nothing, one that breaks for one sample, one that runs away, beside one that works: each is
/// shown as what it is, and none has a mark that it did not earn.
#[test]
fn the_judge_is_not_fooled() {
    let rivals = vec![&SPRING, &STILL, &BROKEN, &RUNAWAY];
    let plan =
        ComparisonPlan::of(&[study("judge", "", MOVING)], rivals, short(&["exact"])).unwrap();
    let comparison = done(&plan, &journal("judge"), 2);
    let outcome = |rival: &str| &tuned(&comparison, rival, "exact").outcome;
    assert_eq!(*outcome("spring"), RunOutcome::Followed);
    assert!(
        matches!(outcome("still"), RunOutcome::Lost { .. } | RunOutcome::Diverged { .. }),
        "{:?}",
        outcome("still")
    );
    let RunOutcome::NotFinite { t, .. } = outcome("broken") else {
        unreachable!("{:?}", outcome("broken"))
    };
    assert!((t - 1.0).abs() < 1e-9, "{t}");
    assert!(matches!(outcome("runaway"), RunOutcome::Lost { .. } | RunOutcome::Diverged { .. }));
    assert!(tuned(&comparison, "broken", "exact").worst.is_none());
    for row in &comparison.rows {
        let columns = row.columns.as_ref().unwrap();
        let good = row.rival == "spring";
        assert_eq!(columns.share_of_draws > 0.0, good, "{}", row.rival);
        assert_eq!(row.tuning.as_ref().unwrap().runs_to_spec.is_some(), good, "{}", row.rival);
        assert!(good || columns.easy.mark == Mark::No);
        assert!(good || columns.quantitative.mark != Mark::Yes);
    }
}

/// At rest a spring gives way by the load over its stiffness: `e_i = −g_i(q)/K_i`. Its bound is the largest load
/// along the reference over the stiffness, so that bound/measured is 1 but for the little that `q` has moved.
#[test]
fn bound_over_measured_is_that_of_a_spring_at_rest() {
    let hold = "kind = \"hold\"\nq_rad = [0.9, 0.5, 0.3]\n";
    let path = study("spring", "[world]\nfriction = \"none\"\n", hold);
    let plan = ComparisonPlan::of(&[path], vec![&SPRING], short(&["exact"])).unwrap();
    let comparison = done(&plan, &journal("spring"), 1);
    let cell = tuned(&comparison, "spring", "exact");
    let figures: &Figures = cell.worst.as_ref().unwrap();
    let (study, outcome) = plan.repeat(&comparison, &cell.runs[0].name).unwrap();
    let model = study.robot.plant_model().with_gravity(study.world.gravity);
    let (mut workspace, mut load) = (Workspace::new(&model), [0.0_f64; 3]);
    let gain = comparison.rows[0].tuning.as_ref().unwrap().tuned[0];
    model.gravity_torque(&mut workspace, &[0.9, 0.5, 0.3], &mut load);
    let stiffness = |i: usize| comparison.arms[0].inertia[i] * gain * gain;
    let mut ratios = Vec::new();
    for (i, joint) in outcome.trace.joints.iter().enumerate() {
        let (expected, found) = (load[i].abs() / stiffness(i), joint.e.last().unwrap().abs());
        assert!((found / expected - 1.0).abs() < 0.05, "{}: {found} for {expected}", joint.name);
        ratios.push(expected / found);
    }
    let ratio = figures.bound_over_measured.unwrap();
    let least = ratios.iter().copied().fold(f64::INFINITY, f64::min);
    assert!((ratio / least - 1.0).abs() < 0.01, "{ratio} for {least}");
}

/// Unknown names are told, and an arm that lacks what a comparison needs.
#[test]
fn what_cannot_be_compared_is_told() {
    let path = study("told", "", MOVING);
    let mut extent = short(&["exact"]);
    extent.only = vec!["pid-of-nobody".to_owned()];
    let message = ComparisonPlan::new(std::slice::from_ref(&path), extent).unwrap_err().to_string();
    assert!(message.contains("pid-of-nobody"), "{message}");
    let message =
        ComparisonPlan::new(std::slice::from_ref(&path), short(&["moon"])).unwrap_err().to_string();
    assert!(message.contains("moon"), "{message}");
    let text = fs::read_to_string(&path).unwrap().replace("payload_max_kg = 0.3\n", "");
    fs::write(&path, text).unwrap();
    let message = ComparisonPlan::new(&[path], short(&["exact"])).unwrap_err().to_string();
    assert!(message.contains("design.payload_max_kg"), "{message}");
}
