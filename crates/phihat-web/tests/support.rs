//! Tasks and answers.

use std::cell::RefCell;

use phihat_web::answer;
use serde_json::Value;

/// The answer to a task.
pub(crate) fn ask(task: &Value) -> Value {
    serde_json::from_str(&answer(&task.to_string(), &|_| ())).unwrap()
}

/// The answer to a task, and the events before it.
pub(crate) fn heard(task: &Value) -> (Value, Vec<Value>) {
    let events = RefCell::new(Vec::new());
    let told = answer(&task.to_string(), &|event| {
        events.borrow_mut().push(serde_json::from_str(event).unwrap());
    });
    (serde_json::from_str(&told).unwrap(), events.into_inner())
}

/// A text of the repository.
pub(crate) fn text(path: &str) -> String {
    let root = concat!(env!("CARGO_MANIFEST_DIR"), "/../../");
    std::fs::read_to_string(format!("{root}{path}")).unwrap()
}

/// The planar arm's description, its first link with the shape of a box.
pub(crate) fn boxed() -> String {
    let shape = "<visual><geometry><box size=\"0.3 0.05 0.05\"/></geometry></visual>";
    let urdf = text("crates/phihat-model/robots/planar3r.urdf");
    let link = "<link name=\"link1\">";
    assert!(urdf.contains(link));
    urdf.replace(link, &format!("{link}{shape}"))
}

/// The first study, its gains left to the design.
pub(crate) fn searched() -> String {
    let first = text("studies/first.toml");
    let (before, rest) = first.split_once("[gains]").unwrap();
    let (_, after) = rest.split_once("[loop]").unwrap();
    format!("{before}[design]\npayload_max_kg = 0.3\n\n[loop]{after}")
}

/// The same with its arm in files beside it.
pub(crate) fn searched_of_files() -> String {
    let first = searched();
    let name = "name = \"planar3r\"";
    assert!(first.contains(name));
    first.replace(name, "file = \"arm/planar3r.toml\"")
}
