//! Expansion of xacro, against that of PyPI's xacro and against values by Python (`xacro/README.md`). Fails where an
//! element, attribute, number or text is otherwise, where Python refuses and we do not, or where a hostile file is
//! costly.

use std::fs;
use std::path::{Path, PathBuf};

use phihat_model::Robot;
use phihat_model::xacro::{XacroOptions, expand};
use serde_json::Value;

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/xacro")
}

/// A folder of its own with one file in it; removed when dropped.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str, text: &str) -> Self {
        let path = std::env::temp_dir().join(format!("phihat-xacro-{}-{name}", std::process::id()));
        fs::create_dir_all(&path).unwrap();
        fs::write(path.join("file.xacro"), text).unwrap();
        Self(path)
    }

    fn expand(&self) -> Result<String, String> {
        let expanded = expand(&self.0.join("file.xacro"), &XacroOptions::default());
        expanded.map(|own| own.urdf).map_err(|why| why.to_string())
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

/// Texts whose words are the same, numbers to twelve digits.
fn same(a: &str, b: &str) -> bool {
    let close = |(a, b): (&str, &str)| {
        a == b
            || match (a.parse::<f64>(), b.parse::<f64>()) {
                (Ok(a), Ok(b)) => (a - b).abs() <= 1e-12 * a.abs().max(1.0),
                _ => false,
            }
    };
    a.split_whitespace().count() == b.split_whitespace().count()
        && a.split_whitespace().zip(b.split_whitespace()).all(close)
}

fn compare(own: roxmltree::Node<'_, '_>, theirs: roxmltree::Node<'_, '_>) {
    assert_eq!(own.tag_name().name(), theirs.tag_name().name());
    let place = format!("<{} {:?}>", own.tag_name().name(), own.attribute("name"));
    assert_eq!(own.attributes().count(), theirs.attributes().count(), "{place}");
    for attribute in theirs.attributes() {
        let (name, value) = (attribute.name(), attribute.value());
        let read = own.attribute(name).unwrap_or_else(|| panic!("{place} lacks {name}"));
        assert!(same(read, value), "{place} {name}: {read:?}, not {value:?}");
    }
    let text = |node: roxmltree::Node<'_, '_>| -> String {
        node.children().filter(roxmltree::Node::is_text).filter_map(|part| part.text()).collect()
    };
    assert!(same(&text(own), &text(theirs)), "{place}");
    let elements =
        |node: roxmltree::Node<'_, '_>| node.children().filter(roxmltree::Node::is_element).count();
    assert_eq!(elements(own), elements(theirs), "{place}");
    let own = own.children().filter(roxmltree::Node::is_element);
    own.zip(theirs.children().filter(roxmltree::Node::is_element)).for_each(|(a, b)| compare(a, b));
}

#[test]
fn files_expand_as_by_the_xacro_of_ros() {
    for name in ["properties", "macros", "conditions", "built", "included"] {
        let path = folder().join(format!("{name}.xacro"));
        let own = expand(&path, &XacroOptions::default()).unwrap_or_else(|why| panic!("{why}"));
        let theirs = fs::read_to_string(folder().join(format!("{name}.urdf"))).unwrap();
        let (own, theirs) = (
            roxmltree::Document::parse(&own.urdf).unwrap(),
            roxmltree::Document::parse(&theirs).unwrap(),
        );
        compare(own.root_element(), theirs.root_element());
    }
}

#[test]
fn expressions_have_the_values_that_python_gives_them() {
    let rows = fs::read_to_string(folder().join("expressions.json")).unwrap();
    let rows: Vec<[Value; 3]> = serde_json::from_str(&rows).unwrap();
    assert_eq!(rows.len(), 600);
    let mut refused = 0;
    for [expression, kind, value] in &rows {
        let expression = expression.as_str().unwrap();
        let text = format!(
            "<robot xmlns:xacro=\"http://ros.org/wiki/xacro\"><xacro:property name=\"a\" value=\"3\"/><xacro:property \
             name=\"b\" value=\"0.25\"/><xacro:property name=\"word\" value=\"arm\"/><xacro:property name=\"flag\" \
             value=\"true\"/><xacro:property name=\"items\" value=\"${{[1, 2.5, 'x']}}\"/><v x=\"${{{}}}\"/></robot>",
            expression.replace('<', "&lt;")
        );
        match (Folder::new("expression", &text).expand(), kind) {
            (Err(_), Value::Null) => refused += 1,
            (Ok(urdf), Value::String(kind)) => {
                let document = roxmltree::Document::parse(&urdf).unwrap();
                let own = document.root_element().first_element_child().unwrap();
                let (own, value) = (own.attribute("x").unwrap(), value.as_str().unwrap());
                assert!(same(own, value), "{expression}: {own}, not {value}");
                // A whole number is written without a point, a float with one.
                assert!(kind != "int" || own.parse::<i64>().is_ok(), "{expression}: {own}");
            }
            (own, _) => panic!("{expression}: {own:?}, by Python {kind} {value}"),
        }
    }
    assert!(refused > 30, "{refused}");
}

/// An arm with a macro for its links, of which the argument says how many there are.
const ARM: &str = r#"<robot name="arm" xmlns:xacro="http://ros.org/wiki/xacro">
  <xacro:arg name="joints" default="2"/>
  <link name="link0"/>
  <xacro:macro name="piece" params="i">
    <link name="link${i}"><inertial><origin xyz="0 0 0.1"/><mass value="${2.0 / i}"/>
      <inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.01"/></inertial></link>
    <joint name="joint${i}" type="revolute"><parent link="link${i - 1}"/><child link="link${i}"/>
      <axis xyz="${i % 2} ${1 - i % 2} 0"/><limit lower="-${pi/2}" upper="${pi/2}" effort="10" velocity="2"/></joint>
    <xacro:if value="${i &lt; $(arg joints)}"><xacro:piece i="${i + 1}"/></xacro:if>
  </xacro:macro>
  <xacro:piece i="1"/>
</robot>"#;

#[test]
fn an_arm_of_xacro_is_a_robot_and_its_arguments_count() {
    let folder = Folder::new("arm", ARM);
    for joints in [2, 5] {
        let mut options = XacroOptions::default();
        options.arguments.insert("joints".to_owned(), joints.to_string());
        let expanded = expand(&folder.0.join("file.xacro"), &options).unwrap();
        let robot = Robot::from_text(&expanded.urdf, None, "arm").unwrap();
        assert_eq!(robot.joints.len(), joints);
        assert!((robot.joints[0].position.unwrap().1 - std::f64::consts::FRAC_PI_2).abs() < 1e-15);
        assert_eq!(expanded.arguments["joints"], joints.to_string());
    }
    let mut options = XacroOptions::default();
    options.arguments.insert("joint".to_owned(), "3".to_owned());
    let why = expand(&folder.0.join("file.xacro"), &options).unwrap_err().to_string();
    assert!(why.contains("no argument \"joint\"") && why.contains("it has joints"), "{why}");
}

/// A mistake in the arm above, and words of its error; each with its line.
const MISTAKES: &[(&str, &str, &[&str])] = &[
    ("${2.0 / i}", "${2.0 / j}", &["file.xacro:5", "`j` is not defined", "macro \"piece\""]),
    ("${2.0 / i}", "${2.0 / (i - 1)}", &["file.xacro:5", "division by zero"]),
    ("${2.0 / i}", "${2.0 / i", &["file.xacro:5"]),
    ("${2.0 / i}", "${2.0 // / i}", &["file.xacro:5", "`/` is not expected"]),
    ("$(arg joints)", "$(arg jonts)", &["file.xacro:9", "no argument \"jonts\""]),
    ("<xacro:piece i=\"1\"/>", "<xacro:peace i=\"1\"/>", &["file.xacro:11", "no macro \"peace\""]),
    ("<xacro:piece i=\"1\"/>", "<xacro:piece/>", &["file.xacro:11", "needs \"i\""]),
    (
        "<xacro:piece i=\"1\"/>",
        "<xacro:piece i=\"1\" k=\"2\"/>",
        &["file.xacro:11", "no parameter \"k\""],
    ),
    (
        "<xacro:piece i=\"1\"/>",
        "<xacro:include filename=\"no.xacro\"/>",
        &["file.xacro:11", "no.xacro"],
    ),
    (
        "<xacro:piece i=\"1\"/>",
        "<xacro:include filename=\"$(find no_such)/a.xacro\"/>",
        &["--package no_such=FOLDER"],
    ),
    (
        "value=\"${i &lt; $(arg joints)}\"",
        "value=\"${i &lt; $(arg joints)} or so\"",
        &["neither true, false nor a number"],
    ),
];

#[test]
fn mistakes_are_named_with_their_place() {
    for (right, instead, clues) in MISTAKES {
        let text = ARM.replacen(right, instead, 1);
        assert_ne!(text, ARM, "{right}");
        let folder = Folder::new("mistake", &text);
        // Text that nothing closes is left as it is, and is no number for whoever reads it.
        let why = match folder.expand() {
            Err(why) => why,
            Ok(urdf) => Robot::from_text(&urdf, None, "file.xacro:5").unwrap_err().to_string(),
        };
        assert!(clues.iter().all(|clue| why.contains(clue)), "{clues:?} in: {why}");
    }
}

/// Files that would take for ever, or fill the memory, are refused.
#[test]
fn hostile_files_cost_little() {
    let whole = |inside: &str| {
        format!(
            "<robot xmlns:xacro=\"http://ros.org/wiki/xacro\">{inside}<v x=\"${{z}}\"/></robot>"
        )
    };
    let mut doubled = String::new();
    for c in b'a'..=b'y' {
        let (own, next) = (char::from(c), char::from(c + 1));
        doubled += "<xacro:property name=\"";
        doubled.push(next);
        doubled += "\" value=\"";
        (0..4).for_each(|_| doubled.extend(['$', '{', own, '}']));
        doubled += "\"/>";
    }
    let cases = [
        (
            "recursion",
            "<xacro:macro name=\"m\" params=\"\"><xacro:m/></xacro:macro><xacro:m/>".to_owned(),
        ),
        (
            "doubling",
            "<xacro:macro name=\"m\" params=\"n\"><xacro:if value=\"${n &lt; 30}\"><xacro:m \
            n=\"${n+1}\"/><xacro:m n=\"${n+1}\"/></xacro:if></xacro:macro><xacro:m n=\"0\"/>"
                .to_owned(),
        ),
        ("itself", "<xacro:property name=\"z\" value=\"${z}\"/>".to_owned()),
        ("text", format!("<xacro:property name=\"a\" value=\"aaaa\"/>{doubled}")),
        ("times", "<xacro:property name=\"z\" value=\"${'a' * 10**9}\"/>".to_owned()),
        ("range", "<xacro:property name=\"z\" value=\"${len(range(10**15))}\"/>".to_owned()),
        ("power", "<xacro:property name=\"z\" value=\"${9**9**9}\"/>".to_owned()),
        (
            "brackets",
            format!(
                "<xacro:property name=\"z\" value=\"${{{}1{}}}\"/>",
                "(".repeat(5000),
                ")".repeat(5000)
            ),
        ),
        ("signs", format!("<xacro:property name=\"z\" value=\"${{{}1}}\"/>", "-".repeat(5000))),
        ("includes", "<xacro:include filename=\"file.xacro\"/>".to_owned()),
    ];
    for (name, inside) in cases {
        let read = Folder::new(name, &whole(&inside)).expand();
        assert!(read.is_err() || name == "power", "{name}: {read:?}");
    }
}
