//! The files of `straight` are the operations of the recursions on a chain of that structure:
//! `PHIHAT_BLESS=1` writes them anew. Fails if they are stale.

use std::fmt::Write;
use std::path::Path;

use super::{Program, Written, WrittenStep, scattered};
use crate::description::JointMotion;
use crate::inertia::LinkInertia;
use crate::lockstep::part::LockstepSegment;
use crate::lockstep::sweep::{ScrewLanes, placed};
use crate::shape::{SegmentShape, Tilt};
use crate::straight::Kernel;
use crate::vector::{Turn, Vec3};
use crate::{Lanes, Model, Robot, Scalar, Workspace};

/// Width of a line of a written file.
const WIDTH: usize = 120;

const INDENT: &str = "        ";

/// Inputs of a program under construction, each with what the written code calls it.
#[derive(Default)]
struct ProgramInputs(Vec<String>);

impl ProgramInputs {
    fn take(&mut self, name: String) -> Written {
        self.0.push(name);
        Written::put(WrittenStep::Input(self.0.len() - 1))
    }

    fn array<const K: usize>(&mut self, name: impl Fn(usize) -> String) -> [Written; K] {
        core::array::from_fn(|k| self.take(name(k)))
    }

    fn part(&mut self, i: usize, shape: SegmentShape) -> LockstepSegment<Written> {
        let zero = Written::splat(0.0);
        let mut one = |name: &str| self.take(format!("arm.{name}({i})"));
        let a = if shape.reaches { one("a") } else { zero };
        let d = if shape.slides { one("d") } else { zero };
        let turn = Turn { c: one("cos_alpha"), s: one("sin_alpha") };
        let (theta, armature, m) = (zero, one("armature"), one("m"));
        let [hx, hy, hz] = self.array(|k| format!("arm.h({i}, {k})"));
        let [xx, yy, zz, xy, xz, yz] = self.array(|k| format!("arm.inertia({i}, {k})"));
        let sigma = self.array(|k| format!("arm.sigma({i}, {k})"));
        let matter = LinkInertia { m, h: Vec3::new(hx, hy, hz), xx, yy, zz, xy, xz, yz };
        LockstepSegment {
            motion: JointMotion::Revolute,
            first: i,
            shape,
            turn,
            a,
            d,
            theta,
            armature,
            matter,
            sigma,
        }
    }
}

/// Forward dynamics of a chain of so many revolute joints, written down.
fn written<const N: usize>(shapes: &[SegmentShape]) -> (Program, Vec<String>) {
    let mut inputs = ProgramInputs::default();
    let program = Program::of(0, |_| {
        let parts: Vec<_> =
            shapes.iter().enumerate().map(|(i, shape)| inputs.part(i, *shape)).collect();
        let lift: [_; 3] = inputs.array(|k| format!("arm.lift({k})"));
        let lift = Vec3::new(lift[0], lift[1], lift[2]);
        let mut side = |name: &str| inputs.array::<N>(|k| format!("arm.{name}({k})"));
        let [sines, cosines, dq, tau] = ["sine", "cosine", "dq", "tau"].map(&mut side);
        let shifts = core::array::from_fn(|i| parts[i].d);
        let mut ddq = [Written::splat(0.0); N];
        let screws = ScrewLanes { sines, cosines, shifts };
        placed((&parts, lift), &screws, [&dq, &tau], &mut ddq);
        ddq.to_vec()
    });
    (program, inputs.0)
}

/// The program as Rust.
fn rust<const N: usize>(title: &str, shapes: &[SegmentShape]) -> String {
    let (program, names) = written::<N>(shapes);
    let name = |k: usize| format!("v{k}");
    let mut statements = Vec::new();
    for k in program.order() {
        let value = match program.steps[k] {
            WrittenStep::Constant(bits) => format!("S::splat({:?})", f64::from_bits(bits)),
            WrittenStep::Input(input) => names[input].clone(),
            WrittenStep::Minus(a) => format!("-{}", name(a)),
            WrittenStep::Plus(a, b) => format!("{} + {}", name(a), name(b)),
            WrittenStep::Less(a, b) => format!("{} - {}", name(a), name(b)),
            WrittenStep::Times(a, b) => format!("{} * {}", name(a), name(b)),
            WrittenStep::Over(a, b) => format!("{} / {}", name(a), name(b)),
            WrittenStep::Sine(_) | WrittenStep::Cosine(_) => panic!("sines are inputs"),
        };
        statements.push(format!("let {} = {value};", name(k)));
    }
    let mut text = String::new();
    let _ = write!(
        text,
        "//! Forward dynamics of {title}: what `lockstep::sweep::placed` does with it, {} operations.\n\
         //!\n\
         //! Written by a test (`written::kernels`): not to be edited.\n\n\
         use super::{{Code, ArmNumbers}};\n\
         use crate::Scalar;\n\
         use crate::shape::{{SegmentShape, Tilt}};\n\n\
         pub(super) struct Chain;\n\n\
         impl Code<{N}> for Chain {{\n    const SHAPES: [SegmentShape; {N}] = [\n",
        program.operations()
    );
    for SegmentShape { tilt, reaches, slides } in shapes {
        let _ = writeln!(
            text,
            "        SegmentShape {{ tilt: Tilt::{tilt:?}, reaches: {reaches}, slides: {slides} }},"
        );
    }
    let _ = write!(
        text,
        "    ];\n\n    \
         #[inline(always)]\n    \
         fn forward<S: Scalar>(arm: &impl ArmNumbers<S>) -> [S; {N}] {{\n"
    );
    let mut line = String::new();
    for statement in statements {
        if !line.is_empty() && line.len() + 1 + statement.len() > WIDTH - INDENT.len() {
            let _ = writeln!(text, "{INDENT}{line}");
            line.clear();
        }
        if !line.is_empty() {
            line.push(' ');
        }
        line += &statement;
    }
    let results: Vec<String> = program.results.iter().map(|k| name(*k)).collect();
    let _ = write!(text, "{INDENT}{line}\n{INDENT}[{}]\n    }}\n}}\n", results.join(", "));
    text
}

fn shapes(model: &Model) -> Vec<SegmentShape> {
    model.segments().iter().map(|segment| SegmentShape::shared(&[segment])).collect()
}

/// Any chain of so many joints.
fn any(joints: usize) -> Vec<SegmentShape> {
    let first = SegmentShape { tilt: Tilt::Level, reaches: false, slides: true };
    let further = SegmentShape { tilt: Tilt::Any, reaches: true, slides: true };
    (0..joints).map(|i| if i == 0 { first } else { further }).collect()
}

#[test]
fn what_is_written_out_is_what_the_recursions_do() {
    let named = |name: &str| shapes(&Robot::named(name).unwrap().model);
    let files = [
        ("panda", rust::<7>("an arm built like the Panda", &named("panda"))),
        ("ur5", rust::<6>("an arm built like the UR5", &named("ur5"))),
        ("planar3r", rust::<3>("a planar arm of three joints", &named("planar3r"))),
        ("chain_of_6", rust::<6>("a chain of six revolute joints", &any(6))),
        ("chain_of_7", rust::<7>("a chain of seven revolute joints", &any(7))),
    ];
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/straight");
    for (name, found) in files {
        let path = folder.join(format!("{name}.rs"));
        if std::env::var_os("PHIHAT_BLESS").is_some() {
            std::fs::write(&path, &found).unwrap();
        }
        let kept = std::fs::read_to_string(&path).unwrap_or_default();
        let stale = "is stale: PHIHAT_BLESS=1 cargo test -p phihat-model --lib kernels";
        assert!(kept == found, "src/straight/{name}.rs {stale}");
    }
}

/// A chain of revolute joints drawn by `seed`: lengths that may be 0, axes across each other or at any angle.
fn drawn(seed: u32, joints: usize) -> Model {
    let numbers = scattered(seed, 16 * joints);
    let mut urdf = "<robot name=\"drawn\"><link name=\"l0\"/>".to_owned();
    for (k, own) in numbers.chunks_exact(16).enumerate() {
        let length = |at: usize| if own[at + 3] > 0.5 { 0.0 } else { 0.2 * own[at] };
        let (x, z) = (length(0), length(1));
        let turn = std::f64::consts::FRAC_PI_2 * own[2].signum();
        let (roll, yaw) = if own[6] > 0.0 { (turn, 0.0) } else { (own[7], own[8]) };
        let [xx, yy, zz] = [9, 10, 11].map(|at| 0.03 + 0.005 * own[at]);
        let _ = write!(
            urdf,
            "<link name=\"l{next}\"><inertial><origin xyz=\"{} {} {}\"/><mass value=\"{}\"/>\
             <inertia ixx=\"{xx}\" iyy=\"{yy}\" izz=\"{zz}\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/></inertial></link>\
             <joint name=\"j{next}\" type=\"revolute\"><parent link=\"l{k}\"/><child link=\"l{next}\"/>\
             <origin rpy=\"{roll} 0 {yaw}\" xyz=\"{x} 0 {z}\"/><axis xyz=\"0 0 1\"/>\
             <limit effort=\"9\" velocity=\"9\" lower=\"-3\" upper=\"3\"/></joint>",
            0.1 * own[12],
            0.1 * own[13],
            0.1 * own[14],
            2.5 + own[15],
            next = k + 1
        );
    }
    Robot::from_text(&(urdf + "</robot>"), None, "drawn.urdf").unwrap().model
}

/// Holds accelerations of one arm against those of the recursions for any arm, which a type without written code takes.
fn compare(model: &Model, rounds: u32) {
    let n = model.joint_count();
    let (mut ws, mut general) = (Workspace::new(model), Workspace::<Lanes>::new(model));
    let (mut found, mut expected) = (vec![0.0; n], vec![Lanes::default(); n]);
    for round in 0..rounds {
        let state = scattered(round, 3 * n);
        let side = |k: usize| &state[k * n..][..n];
        model.forward_dynamics(&mut ws, side(0), side(1), side(2), &mut found);
        let lanes = |k: usize| side(k).iter().map(|x| Lanes::splat(*x)).collect::<Vec<_>>();
        model.forward_dynamics(&mut general, &lanes(0), &lanes(1), &lanes(2), &mut expected);
        for (found, expected) in found.iter().zip(&expected) {
            let expected = <[f64; Lanes::COUNT]>::from(*expected)[0];
            // Folding leaves no sign of a zero.
            assert_eq!((found + 0.0).to_bits(), (expected + 0.0).to_bits(), "{found} {expected}");
        }
    }
}

#[test]
fn what_is_written_out_gives_the_bits_of_the_recursions_for_any_arm() {
    for (name, kernel) in [
        ("panda", Kernel::Panda),
        ("iiwa14", Kernel::ChainOf7),
        ("ur5", Kernel::Ur5),
        ("planar3r", Kernel::Planar3r),
    ] {
        let model = Robot::named(name).unwrap().model;
        assert_eq!(model.compiled().kernel, Some(kernel), "{name}");
        compare(&model, 200);
        compare(&model.with_gravity([3.0, -4.0, 5.0]), 20);
    }
    let mut kernels = Vec::new();
    for seed in 1..=80 {
        let model = drawn(seed, 6 + usize::from(seed % 2 == 0));
        kernels.extend(model.compiled().kernel);
        compare(&model, 10);
    }
    assert!(kernels.len() > 60, "{} of 80 chains have code of their own", kernels.len());
}

#[test]
fn code_serves_what_has_no_more_than_it() {
    let shape = |tilt, reaches, slides| SegmentShape { tilt, reaches, slides };
    let panda = shapes(&Robot::named("panda").unwrap().model);
    let mut less = panda.clone();
    less[3].reaches = false;
    assert_eq!(Kernel::of(&less), Some(Kernel::Panda));
    let mut more = panda.clone();
    more[1].reaches = true;
    assert_eq!(Kernel::of(&more), Some(Kernel::ChainOf7));
    let mut turned = panda;
    turned[4].tilt = Tilt::Down;
    assert_eq!(Kernel::of(&turned), Some(Kernel::ChainOf7));
    assert_eq!(Kernel::of(&[shape(Tilt::Level, false, true); 5]), None);
}
