//! From an MJCF document to the links and joints of a description.

use std::collections::BTreeMap;

use roxmltree::Document;

use super::actuators::Actuators;
use super::attributes::values;
use super::bodies::{Bodies, Coordinate, LinkOfBody, Surroundings};
use super::classes::DefaultClasses;
use super::compiler::CompilerSettings;
use super::equality::followers;
use super::include::included;
use super::inertia::StatedMatter;
use crate::markup::MarkupElement;
use crate::model::GRAVITY;
use crate::named_texts::NamedFile;
use crate::placement::Placement;
use crate::whole::{DescribedFile, LinkElement, Result, checked_matter};

/// Most postures that are read.
const POSES_MAX: usize = 100;

/// Links and joints of an MJCF document.
pub(crate) fn described(
    document: &Document<'_>,
    path: Option<NamedFile<'_>>,
    origin: &str,
) -> Result<DescribedFile> {
    let (root, included) = included(document, path, origin)?;
    let settings = CompilerSettings::of(&root)?;
    let classes = DefaultClasses::of(&root)?;
    let actuators = Actuators::of_file(&root, &classes, &settings)?;
    let (followers, mut warnings) = followers(&root, &classes)?;
    let about = Surroundings {
        settings: &settings,
        classes: &classes,
        actuators: &actuators,
        followers: &followers,
    };
    let mut bodies = Bodies::of(&root, about)?;
    bodies.follow();
    let poses = poses(&root, &bodies.coordinates)?;
    let Bodies { links, joints, .. } = bodies;
    let links = weighed(links, &settings)?;
    warnings.extend(tendons(&root)?);
    if settings.has_medium {
        warnings.push("the drag of the medium in <option> is not read".to_owned());
    }
    if settings.gravity.iter().zip(GRAVITY).any(|(own, usual)| (own - usual).abs() > 0.0) {
        warnings.push(format!(
            "gravity {:?} m/s² of the file is that of the model alone; a study states its own, gravity_m_s2 in [world]",
            settings.gravity
        ));
    }
    Ok(DescribedFile {
        name: root.attribute("model").unwrap_or("robot").to_owned(),
        origin: origin.to_owned(),
        included,
        links,
        joints,
        follows: "<equality>",
        gravity: Some(settings.gravity),
        poses,
        warnings,
        notes: Vec::new(),
    })
}

/// Links with their matter checked, scaled to the mass of all where the file states that.
fn weighed(mut links: Vec<LinkOfBody>, settings: &CompilerSettings) -> Result<Vec<LinkElement>> {
    let factor = match settings.total_mass {
        None => 1.0,
        Some(total) => {
            let mut sum = 0.0;
            for link in &mut links {
                if let Ok(matter) = &link.matter {
                    sum += matter.body.mass;
                } else {
                    let none = Ok(StatedMatter::none(Placement::IDENTITY));
                    std::mem::replace(&mut link.matter, none)?;
                }
            }
            if sum > 0.0 { total / sum } else { 1.0 }
        }
    };
    let checked = |LinkOfBody { element, matter, odd }: LinkOfBody| {
        let matter = matter.and_then(|matter| {
            let StatedMatter { body, at } = matter.times(factor);
            let (matter, more) = checked_matter(&element, (body, &at))?;
            Ok((matter, odd.into_iter().chain(more).collect()))
        });
        LinkElement { element, matter }
    };
    Ok(links.into_iter().map(checked).collect())
}

/// Postures of the file by name: positions by the joint's name.
fn poses(
    root: &MarkupElement,
    coordinates: &[Coordinate],
) -> Result<BTreeMap<String, BTreeMap<String, f64>>> {
    let size: usize = coordinates.iter().map(|own| own.size).sum();
    let mut poses = BTreeMap::new();
    let sections = root.elements().filter(|section| section.name == "keyframe");
    for key in sections.flat_map(MarkupElement::elements).take(POSES_MAX) {
        let (Some(name), Some(all)) = (key.attribute("name"), values(key, "qpos")?) else {
            continue;
        };
        if all.len() != size || name.is_empty() || all.iter().any(|x| !x.is_finite()) {
            continue;
        }
        let (mut at, mut pose) = (0, BTreeMap::new());
        for coordinate in coordinates {
            if let (Some(joint), Some(value)) = (&coordinate.joint, all.get(at)) {
                pose.insert(joint.clone(), *value);
            }
            at += coordinate.size;
        }
        poses.insert(name.to_owned(), pose);
    }
    Ok(poses)
}

/// Tendons that act on joints by themselves.
fn tendons(root: &MarkupElement) -> Result<Option<String>> {
    const ACTS: [&str; 4] = ["stiffness", "damping", "frictionloss", "armature"];
    let mut found = 0;
    let sections = root.elements().filter(|section| section.name == "tendon");
    for tendon in sections.flat_map(MarkupElement::elements) {
        for key in ACTS {
            found +=
                usize::from(values(tendon, key)?.unwrap_or_default().iter().any(|x| *x != 0.0));
        }
    }
    Ok((found > 0)
        .then(|| "springs, damping, friction and inertia of tendons are not read".to_owned()))
}
