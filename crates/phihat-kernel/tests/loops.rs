//! Polynomials of random loops against eigenvalues of the same loops written sample by sample. Wrong if a delay, a
//! drive, a filter or the reported torque entered in another way than they run.

use nalgebra::{Complex, DMatrix};
use phihat_kernel::{JointLoop, Law, Number, Polynomial, Range, Unproved, frozen};

use crate::random::{Dice, Memory, alone, law, radius, setting};

fn value(p: &Polynomial, z: Complex<f64>) -> (Complex<f64>, f64) {
    let c: Vec<f64> = p.coefficients().iter().map(Number::near).collect();
    let none = (Complex::new(0.0, 0.0), 0.0);
    c.iter().rev().fold(none, |(sum, size), c| (sum * z + c, size * z.norm() + c.abs()))
}

#[test]
fn roots_are_eigenvalues() {
    let mut dice = Dice(3);
    for case in 0..200 {
        let states = dice.below(4);
        let (law, setting) = (law(&mut dice, states), setting(&mut dice));
        let joint = JointLoop::new(&law, &setting).unwrap();
        for mu in [0.4, 1.0, 3.0] {
            let a = alone(&law, &setting, mu);
            let p = joint.at(&Number::of(mu).unwrap());
            // Away from the roots: the determinant, up to roots at zero and a factor.
            let at = |z: Complex<f64>| {
                let shifted = DMatrix::identity(a.nrows(), a.nrows()) * z - a.map(Into::into);
                let idle = i32::try_from(a.nrows() - p.degree()).unwrap();
                shifted.determinant() / z.powi(idle) / value(&p, z).0
            };
            let first = at(Complex::new(1.3, 0.2));
            for z in [Complex::new(-1.1, 0.4), Complex::new(0.2, 1.2), Complex::new(0.6, 0.9)] {
                let off = (at(z) / first - 1.0).norm();
                assert!(
                    off < 1e-8,
                    "{case} {mu} {off} {} {} {setting:?} {law:?}",
                    a.nrows(),
                    p.degree()
                );
            }
        }
    }
}

#[test]
fn stable_is_what_eigenvalues_say() {
    let mut dice = Dice(4);
    let (mut stable, mut growing) = (0, 0);
    for _ in 0..400 {
        let states = dice.below(5);
        let (law, setting) = (law(&mut dice, states), setting(&mut dice));
        let joint = JointLoop::new(&law, &setting).unwrap();
        let mu = 4.0_f64.powf(dice.roll());
        let found = radius(&alone(&law, &setting, mu));
        if (found - 1.0).abs() < 1e-6 {
            continue;
        }
        let range = Range::new(mu, mu).unwrap();
        let proved = |joint: JointLoop| frozen(&[joint], &range).is_ok();
        assert_eq!(proved(joint.clone()), found < 1.0, "{found} {law:?} {setting:?}");
        // On both sides of its slowest root.
        let within = |share: f64| joint.within(&Number::of(found * share).unwrap());
        assert!(proved(within(1.000_001)) && !proved(within(0.999_999)), "{found}");
        if found < 1.0 { stable += 1 } else { growing += 1 }
    }
    println!("{stable} stable, {growing} growing");
    assert!(stable > 100 && growing > 50, "{stable} {growing}");
}

#[test]
fn kicks_and_misreadings_are_answered_as_the_loop_does() {
    let mut dice = Dice(5);
    for _ in 0..60 {
        let states = dice.below(4);
        let (law, mut setting) = (law(&mut dice, states), setting(&mut dice));
        setting.drive = None;
        let joint = JointLoop::new(&law, &setting).unwrap();
        let z = Complex::from_polar(3.0, dice.between(0.1, 3.0));
        let t = setting.period;
        // Torque that acts, from an acceleration or a kick of one sample, and the command from one misreading, all with
        // the inertia infinite; far out of the circle the sums converge.
        let sum = |kick: bool, misread: bool| {
            let mut memory = Memory::new(&law, &setting);
            let (mut total, mut power) = (Complex::new(0.0, 0.0), Complex::new(1.0, 0.0));
            for k in 0..200 {
                let now = if misread && k == 0 { 1.0 } else { 0.0 };
                let (mean, _, command) = memory.answer(&law, &setting, now);
                total += power * if misread { command } else { mean };
                power /= z;
                memory.q += t * memory.v;
                if k == 0 && !misread {
                    memory.q += 0.5 * t * t;
                    memory.v += if kick { 0.0 } else { t };
                }
            }
            total
        };
        let ratio = |top: &Polynomial| value(top, z).0 / value(&joint.open, z).0;
        let near = |own: Complex<f64>, want: Complex<f64>| (own - want).norm() < 1e-9 * want.norm();
        let inertia = setting.inertia;
        // `open` is times M̄.
        assert!(near(-ratio(&joint.back) * inertia, sum(false, false)));
        assert!(near(-ratio(joint.kick.as_ref().unwrap()) * inertia, sum(true, false)));
        let idle = ratio(&joint.reading).norm() / sum(false, true).norm();
        let power = idle.ln() / z.norm().ln();
        assert!((power - power.round()).abs() < 1e-9 && power > -0.5, "{power}");
    }
}

#[test]
fn what_is_no_loop_is_refused() {
    let mut dice = Dice(6);
    let (good, around) = (law(&mut dice, 2), setting(&mut dice));
    assert!(JointLoop::new(&good, &around).is_ok());
    let mut bad: Vec<Law> = vec![good.clone(); 5];
    bad[0].state.pop();
    bad[1].input.pop();
    bad[2].output.push(0.0);
    bad[3].direct[1] = f64::NAN;
    bad[4].state[1][0] = f64::INFINITY;
    for law in bad {
        assert_eq!(JointLoop::new(&law, &around), Err(Unproved::NoLoop));
    }
    for (low, high) in [(0.0, 1.0), (2.0, 1.0), (-1.0, 1.0), (1.0, f64::INFINITY), (f64::NAN, 1.0)]
    {
        assert_eq!(Range::new(low, high), Err(Unproved::NoClaim));
    }
}
