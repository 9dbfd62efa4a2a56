//! Shared by the tests: oracles, random numbers, comparisons.
#![allow(dead_code, reason = "each test uses a part")]

use std::fmt::Write as _;
use std::time::Duration;

use phihat_model::{Model, Robot, Workspace};
use serde_json::Value;

/// Processor time of this thread.
#[cfg(unix)]
pub(crate) fn processor_time() -> Duration {
    let time = rustix::time::clock_gettime(rustix::time::ClockId::ThreadCPUTime);
    Duration::new(time.tv_sec.unsigned_abs(), u32::try_from(time.tv_nsec).unwrap())
}

/// Zero where the system gives no processor time: it is then not bounded.
#[cfg(not(unix))]
pub(crate) fn processor_time() -> Duration {
    Duration::ZERO
}

/// A splitmix64 generator: small, seeded, the same everywhere.
pub(crate) struct Random(pub(crate) u64);

impl Random {
    pub(crate) fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// Uniform in (low, high).
    pub(crate) fn within(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * ((self.next() >> 11) as f64 + 0.5) / (1_u64 << 53) as f64
    }

    pub(crate) fn below(&mut self, n: usize) -> usize {
        usize::try_from(self.next() % n as u64).expect("less than n")
    }

    pub(crate) fn vector(&mut self, n: usize, size: f64) -> Vec<f64> {
        (0..n).map(|_| self.within(-size, size)).collect()
    }
}

/// Largest difference over the largest magnitude of `expected`.
pub(crate) fn relative_error(found: &[f64], expected: &[f64]) -> f64 {
    assert_eq!(found.len(), expected.len());
    let scale = expected.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    let error = found.iter().zip(expected).fold(0.0_f64, |m, (a, b)| {
        let difference = (a - b).abs();
        if difference.is_nan() { f64::INFINITY } else { m.max(difference) }
    });
    if scale > 0.0 { error / scale } else { error }
}

/// All numbers of a JSON value, nested arrays flattened.
pub(crate) fn numbers(value: &Value) -> Vec<f64> {
    match value {
        Value::Array(items) => items.iter().flat_map(numbers).collect(),
        _ => vec![value.as_f64().expect("a number")],
    }
}

pub(crate) fn oracle(name: &str) -> Value {
    let path = format!("{}/tests/oracle/{name}.json", env!("CARGO_MANIFEST_DIR"));
    serde_json::from_str(&std::fs::read_to_string(path).expect("an oracle")).expect("JSON")
}

pub(crate) fn robots() -> impl Iterator<Item = Robot> {
    Robot::names().iter().map(|name| Robot::named(name).expect("a built-in arm"))
}

pub(crate) fn mass_matrix(model: &Model, ws: &mut Workspace, q: &[f64]) -> Vec<f64> {
    let n = model.joint_count();
    let mut m = vec![0.0; n * n];
    model.mass_matrix(ws, q, &mut m);
    m
}

pub(crate) fn times(m: &[f64], x: &[f64]) -> Vec<f64> {
    m.chunks(x.len()).map(|row| row.iter().zip(x).map(|(a, b)| a * b).sum()).collect()
}

pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// A random tree with its bodies: forks, sliders, oblique and nearly parallel axes, fixed links.
pub(crate) struct Tree {
    pub(crate) urdf: String,
    /// Per link: name, mass, centre of mass, inertia about it as in a URDF.
    pub(crate) bodies: Vec<(String, f64, [f64; 3], [f64; 6])>,
    pub(crate) model: Model,
}

pub(crate) fn trees() -> Vec<Tree> {
    (1..=12).map(|seed| tree(seed, 3 + usize::from(seed) % 8, seed % 3 != 0)).collect()
}

pub(crate) fn tree(seed: u8, links: usize, forks: bool) -> Tree {
    let mut random = Random(u64::from(seed));
    let mut urdf = "<robot name=\"tree\"><link name=\"root\"/>".to_owned();
    let mut bodies = Vec::new();
    for at in 1..=links {
        let name = format!("link{at}");
        let mass = random.within(0.5, 4.0);
        let com = [0; 3].map(|_| random.within(-0.2, 0.2));
        let d = [0; 3].map(|_| random.within(0.01, 0.05));
        let [a, b, c] = [0; 3].map(|_| random.within(-0.005, 0.005));
        let inertia = [d[1] + d[2], a, b, d[0] + d[2], c, d[0] + d[1]];
        let [xx, xy, xz, yy, yz, zz] = inertia;
        let parent = match at {
            1 => "root".to_owned(),
            _ if forks && random.within(0.0, 1.0) < 0.4 => match random.below(at) {
                0 => "root".to_owned(),
                k => format!("link{k}"),
            },
            _ => format!("link{}", at - 1),
        };
        let kind = match random.next() % 6 {
            0 if at > 1 && at < links => "fixed",
            1 => "prismatic",
            _ => "revolute",
        };
        let xyz = [0; 3].map(|_| random.within(-0.4, 0.4));
        let rpy = match random.next() % 4 {
            0 => [random.within(-1e-3, 1e-3), random.within(-1e-3, 1e-3), random.within(-3.0, 3.0)],
            1 => [std::f64::consts::FRAC_PI_2, 0.0, 0.0],
            2 => [0.0; 3],
            _ => [0; 3].map(|_| random.within(-3.0, 3.0)),
        };
        let axis = match random.next() % 3 {
            0 => [0.0, 0.0, 1.0],
            1 => [0.0, -1.0, 0.0],
            _ => [0; 3].map(|_| random.within(-1.0, 1.0)),
        };
        let triple = |v: [f64; 3]| format!("{} {} {}", v[0], v[1], v[2]);
        let _ = write!(
            urdf,
            "<link name=\"{name}\"><inertial><origin xyz=\"{}\"/><mass value=\"{mass}\"/><inertia \
             ixx=\"{xx}\" ixy=\"{xy}\" ixz=\"{xz}\" iyy=\"{yy}\" iyz=\"{yz}\" izz=\"{zz}\"/>\
             </inertial></link><joint name=\"joint{at}\" type=\"{kind}\"><parent link=\"{parent}\"/>\
             <child link=\"{name}\"/><origin xyz=\"{}\" rpy=\"{}\"/><axis xyz=\"{}\"/>\
             <limit lower=\"-2\" upper=\"2\" effort=\"100\" velocity=\"5\"/></joint>",
            triple(com),
            triple(xyz),
            triple(rpy),
            triple(axis)
        );
        bodies.push((name, mass, com, inertia));
    }
    urdf += "</robot>";
    let model = Robot::from_text(&urdf, None, "tree").expect("a tree").model;
    Tree { urdf, bodies, model }
}

/// The built-in arms and the random trees.
pub(crate) fn models() -> Vec<Model> {
    let arms = robots().map(|robot| robot.model);
    arms.chain(trees().into_iter().map(|tree| tree.model)).collect()
}

/// A URDF of one chain: per joint its type, placement (`xyz` and `rpy`), axis, and the child's
/// mass, centre of mass and inertia (`ixx … izz` as attributes).
pub(crate) fn link(name: &str, inertial: &str) -> String {
    format!("<link name=\"{name}\">{inertial}</link>")
}

pub(crate) fn inertial(mass: f64, com: [f64; 3], i: [f64; 6]) -> String {
    let ([x, y, z], [xx, xy, xz, yy, yz, zz]) = (com, i);
    format!(
        "<inertial><origin xyz=\"{x} {y} {z}\"/><mass value=\"{mass}\"/><inertia ixx=\"{xx}\" \
         ixy=\"{xy}\" ixz=\"{xz}\" iyy=\"{yy}\" iyz=\"{yz}\" izz=\"{zz}\"/></inertial>"
    )
}

pub(crate) fn joint(name: &str, kind: &str, ends: [&str; 2], xyz: &str, axis: &str) -> String {
    format!(
        "<joint name=\"{name}\" type=\"{kind}\"><parent link=\"{}\"/><child link=\"{}\"/>\
         <origin xyz=\"{xyz}\"/><axis xyz=\"{axis}\"/>\
         <limit lower=\"-3\" upper=\"3\" effort=\"10\" velocity=\"1\"/></joint>",
        ends[0], ends[1]
    )
}

pub(crate) fn model_of(parts: &[String]) -> Model {
    let urdf = format!("<robot name=\"test\">{}</robot>", parts.concat());
    Robot::from_text(&urdf, None, "test").expect("a robot").model
}
