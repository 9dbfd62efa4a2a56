//! Matter of a link, checked: what belongs to no body is refused, what is odd is noted.

use super::{NamedElement, Result};
use crate::body::{Body, LumpedBody};
use crate::placement::{Placement, dot, mul, transpose};

/// Radius of gyration, and distance of a centre of mass, beyond which units are doubted \[m\].
const FAR: f64 = 5.0;

/// Matter in a link's frame, and its oddities, of a body that stands at `at` in it, with its centre of mass
/// in the origin of its own axes.
pub(crate) fn checked_matter(
    link: &NamedElement,
    (mut stated, at): (Body, &Placement),
) -> Result<(LumpedBody, Vec<String>)> {
    let (mut odd, mass) = (Vec::new(), stated.mass);
    if let Some(raised) = stated.raised_if_rounded() {
        let by = raised.inertia[0] - stated.inertia[0];
        odd.push(format!(
            "link \"{}\": inertia with a negative principal moment, by rounding: all three raised by {by:.1e} kg·m²",
            link.name
        ));
        stated = raised;
    }
    stated.check().map_err(|why| link.error(why.to_string()))?;
    if !stated.obeys_triangle_inequality() {
        odd.push(format!(
            "link \"{}\": no mass distribution has this inertia (triangle inequality)",
            link.name
        ));
    }
    if mass <= 0.0 && stated.inertia.iter().any(|x| x.abs() > 0.0) {
        odd.push(format!("link \"{}\": it has inertia but no mass", link.name));
    }
    odd.extend(doubts(link, &at.p, &stated));
    let [xx, xy, xz, yy, yz, zz] = stated.inertia;
    let turned = mul(&mul(&at.r, &[[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]), &transpose(&at.r));
    let [[xx, xy, xz], [_, yy, yz], [_, _, zz]] = turned;
    Ok((Body { com: at.p, inertia: [xx, xy, xz, yy, yz, zz], ..stated }.lumped(), odd))
}

/// Doubts about the units of a link's figures: no link of an arm is this large.
fn doubts(link: &NamedElement, centre: &[f64; 3], body: &Body) -> Vec<String> {
    let mut odd = Vec::new();
    let place = |why: String| format!("link \"{}\" (line {}): {why}", link.name, link.line);
    let [xx, _, _, yy, _, zz] = body.inertia;
    let largest = xx.max(yy).max(zz);
    let gyration = (largest / body.mass).sqrt();
    if body.mass > 0.0 && gyration > FAR {
        odd.push(place(format!(
            "an inertia of {largest} kg·m² with a mass of {} kg is a radius of gyration of {gyration:.3} m; if it is \
                kg·mm², divide by 1e6, if g·mm², by 1e9",
            body.mass
        )));
    }
    let away = dot(*centre, *centre).sqrt();
    if away > FAR {
        odd.push(place(format!(
            "the centre of mass is {away:.3} m from the link's frame; if it is in mm, divide by 1000"
        )));
    }
    odd
}
