//! The worlds in which one study is run: extreme ones, and some drawn from its scope.

use phihat_session::Dice;

use crate::draft::{DraftLoad, DraftScope, DraftWorld};

/// The study's own world first; `count` in all, fewer where the scope is a single point.
pub fn worlds(
    nominal: &DraftWorld,
    scope: &DraftScope,
    dice: &mut Dice,
    count: usize,
) -> Vec<(String, DraftWorld)> {
    let mut all = vec![("as the study says".to_owned(), nominal.clone())];
    let (light, heavy) = scope.mass;
    let free = heavy > 0.0 || scope.coulomb.0 != scope.coulomb.1;
    let displaced =
        |dice: &mut Dice| nominal.coulomb.iter().map(|_| dice.between(-0.5, 0.5)).collect();
    if !free {
        let phase = displaced(dice);
        all.push(("1: encoders displaced".to_owned(), DraftWorld { phase, ..nominal.clone() }));
        return all;
    }
    for k in 1..count {
        let (name, mass, level): (_, _, &[f64]) = match k {
            1 => ("lightest, least friction", light, &[0.0]),
            2 => ("heaviest, most friction", heavy, &[1.0]),
            3 => ("heaviest, least friction", heavy, &[0.0]),
            4 => ("lightest, most friction", light, &[1.0]),
            _ if k % 2 == 0 => ("corners drawn", dice.pick(&[light, heavy]), &[0.0, 1.0]),
            _ => ("drawn", dice.between(light, heavy), &[]),
        };
        let load = (mass > 0.0).then(|| load(dice, scope, mass, k % 2 == 0 || k < 5));
        let (low, high) = &scope.coulomb;
        let coulomb = low.iter().zip(high).map(|(low, high)| {
            let share = if level.is_empty() { dice.share() } else { dice.pick(level) };
            low + (high - low) * share
        });
        let coulomb = coulomb.collect();
        all.push((format!("{k}: {name}"), DraftWorld { load, coulomb, phase: displaced(dice) }));
    }
    all
}

/// A body inside the set: at a corner of the box, or anywhere in it.
fn load(dice: &mut Dice, scope: &DraftScope, mass: f64, corner: bool) -> DraftLoad {
    let com = scope.com.map(
        |(low, high)| {
            if corner { dice.pick(&[low, high]) } else { dice.between(low, high) }
        },
    );
    let share = if corner { dice.pick(&[0.0, 1.0]) } else { dice.share() };
    let radius = scope.gyration * share;
    // Second moments: of a needle along a corner of the cube, whose entries are as large as any, or of a ball.
    let v = [(); 3].map(|()| radius * dice.pick(&[-1.0, 1.0]));
    let ball = dice.chance(0.3);
    let second = |i: usize, j: usize| {
        if !ball {
            mass * v[i] * v[j]
        } else if i == j {
            mass * radius * radius
        } else {
            0.0
        }
    };
    let trace = (0..3).map(|i| second(i, i)).sum::<f64>();
    let moment = |i: usize| trace - second(i, i);
    let inertia = [moment(0), -second(0, 1), -second(0, 2), moment(1), -second(1, 2), moment(2)];
    DraftLoad { mass, com, inertia }
}
