//! Shapes of an arm, from its files. Wrong if a cube in four formats were not the same cube, where its URDF
//! puts it; if fewer triangles enclosed another volume; if a file outside of the folder were read; or if
//! bytes that are no mesh did more than cause a report.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use phihat_model::{LinkShape, Look, Robot};

/// The corners of a cube of 2 around the origin, and its faces, outwards.
const FACES: [[usize; 4]; 6] =
    [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];

fn corner(k: usize) -> [f64; 3] {
    core::array::from_fn(|i| if k >> i & 1 == 1 { 1.0 } else { -1.0 })
}

fn triangles() -> Vec<[[f64; 3]; 3]> {
    let halves = |f: [usize; 4]| [[f[0], f[1], f[2]], [f[0], f[2], f[3]]];
    FACES.into_iter().flat_map(halves).map(|t| t.map(corner)).collect()
}

fn stl_of(triangles: &[[[f64; 3]; 3]]) -> Vec<u8> {
    let mut bytes = b"solid, says the head of many binary files".to_vec();
    bytes.resize(80, b' ');
    bytes.extend(u32::try_from(triangles.len()).unwrap().to_le_bytes());
    for triangle in triangles {
        bytes.extend([0; 12]);
        #[allow(clippy::cast_possible_truncation, reason = "what the format holds")]
        bytes.extend(triangle.iter().flatten().flat_map(|x| (*x as f32).to_le_bytes()));
        bytes.extend([0; 2]);
    }
    bytes
}

fn words() -> String {
    let mut text = "solid cube\n".to_owned();
    for [a, b, c] in triangles() {
        text += "facet normal 0 0 0\nouter loop\n";
        for [x, y, z] in [a, b, c] {
            let _ = writeln!(text, "vertex {x} {y:e} {z}");
        }
        text += "endloop\nendfacet\n";
    }
    text + "endsolid cube\n"
}

fn obj() -> String {
    let mut text = "# a cube\nmtllib none.mtl\n".to_owned();
    for [x, y, z] in (0..8).map(corner) {
        let _ = writeln!(text, "v {x} {y} {z}");
    }
    for (k, f) in FACES.iter().enumerate() {
        // All ways in which a corner is named.
        let own = |c: usize| match k % 3 {
            0 => format!("{}", c + 1),
            1 => format!("{}//1", c + 1),
            _ => format!("-{}/1/1", 8 - c),
        };
        let _ = writeln!(text, "f {} {} {} {}", own(f[0]), own(f[1]), own(f[2]), own(f[3]));
    }
    text
}

/// In millimetres, at half its size, turned and shifted by nodes that undo it.
fn collada() -> String {
    let numbers: Vec<_> = (0..8).flat_map(corner).map(|x| (500.0 * x).to_string()).collect();
    let corners: Vec<_> = FACES.iter().flatten().map(|c| format!("{c} 0")).collect();
    format!(
        r##"<?xml version="1.0"?><COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit name="millimetre" meter="0.001"/><up_axis>Y_UP</up_axis></asset>
<library_geometries><geometry id="cube"><mesh>
<source id="p"><float_array id="n" count="24">{}</float_array><technique_common>
<accessor source="#n" count="8" stride="3"/></technique_common></source>
<source id="m"><float_array id="k" count="3">0 0 1</float_array></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<polylist count="6"><input semantic="VERTEX" source="#v" offset="0"/>
<input semantic="NORMAL" source="#m" offset="1"/><vcount>4 4 4 4 4 4</vcount><p>{}</p></polylist>
</mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s"><node><translate>0 0 300</translate><rotate>0 0 1 90</rotate>
<node><matrix>2 0 0 0  0 2 0 0  0 0 2 -300  0 0 0 1</matrix><instance_geometry url="#cube"/></node>
</node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene></COLLADA>"##,
        numbers.join(" "),
        corners.join(" ")
    )
}

fn urdf(mesh: &str) -> String {
    format!(
        r#"<robot name="rod"><link name="base"/><joint name="pivot" type="revolute">
<parent link="base"/><child link="rod"/><axis xyz="0 1 0"/>
        <limit lower="-3" upper="3" effort="40" velocity="5"/></joint>
        <link name="rod"><inertial><origin xyz="0 0 -0.4"/>
        <mass value="2"/><inertia ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0"/></inertial>
        {mesh}</link></robot>"#
    )
}

fn visual(file: &str) -> String {
    format!(
        r#"<visual><origin xyz="0 0 1" rpy="0 0 1.5707963267948966"/>
        <geometry><mesh filename="{file}" scale="0.1 0.2 0.3"/></geometry></visual>"#
    )
}

/// A folder with an arm in `arm/urdf/`, of this visual.
fn folder(name: &str, visual: &str) -> (PathBuf, Robot) {
    let root = std::env::temp_dir().join(format!("phihat-look-{name}-{}", std::process::id()));
    let _ = std::fs::remove_dir_all(&root);
    for place in ["arm/urdf", "arm/meshes", "other"] {
        std::fs::create_dir_all(root.join(place)).unwrap();
    }
    let path = root.join("arm/urdf/rod.urdf");
    std::fs::write(&path, urdf(visual)).unwrap();
    let robot = Robot::read(&path).unwrap();
    (root, robot)
}

/// Six times the enclosed volume, by the divergence theorem.
fn volume(shape: &LinkShape) -> f64 {
    let part = |t: &[usize; 3]| {
        let [a, b, c] = t.map(|k| shape.points[k]);
        a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0])
            + a[2] * (b[0] * c[1] - b[1] * c[0])
    };
    shape.triangles.iter().map(part).sum::<f64>() / 6.0
}

#[test]
fn a_cube_is_the_same_in_every_format() {
    let (root, robot) = folder("formats", "");
    let files = [
        ("arm/meshes/cube.stl", stl_of(&triangles()), "../meshes/cube.stl"),
        ("arm/meshes/words.STL", words().into_bytes(), "package://arm/meshes/words.STL"),
        ("other/cube.obj", obj().into_bytes(), "package://other/cube.obj"),
        ("arm/urdf/cube.dae", collada().into_bytes(), "cube.dae"),
    ];
    for (path, bytes, named) in files {
        std::fs::write(root.join(path), bytes).unwrap();
        std::fs::write(root.join("arm/urdf/rod.urdf"), urdf(&visual(named))).unwrap();
        let Look { shapes, missing, triangles_read } = robot.look(100, None);
        assert!(missing.is_empty(), "{path}: {missing:?}");
        let [shape] = &shapes[..] else { panic!("{path}: {shapes:?}") };
        assert_eq!((&*shape.link, shape.points.len(), triangles_read), ("rod", 8, 12), "{path}");
        assert_eq!(shape.triangles.len(), 12, "{path}");
        // Scaled, then turned by a quarter about z, then lifted.
        for point in &shape.points {
            let far = [point[0].abs() - 0.2, point[1].abs() - 0.1, (point[2] - 1.0).abs() - 0.3];
            assert!(far.iter().all(|x| x.abs() < 1e-6), "{path}: {point:?}");
        }
        assert!((volume(shape) - 0.4 * 0.2 * 0.6).abs() < 1e-6, "{path}: {}", volume(shape));
    }
    std::fs::remove_dir_all(root).unwrap();
}

#[test]
fn shapes_without_a_file() {
    let shapes = r#"<visual><geometry><box size="1 2 3"/></geometry></visual>
        <visual><origin xyz="9 0 0"/><geometry><cylinder radius="1" length="2"/></geometry></visual>
        <visual><origin xyz="-9 0 0"/><geometry><sphere radius="1"/></geometry></visual>"#;
    let (root, robot) = folder("primitives", shapes);
    let look = robot.look(10_000, None);
    let whole = volume(&look.shapes[0]);
    // Round things have flat sides, inside of what they stand for: they lack some per cent.
    let exact = 6.0 + core::f64::consts::PI * (2.0 + 4.0 / 3.0);
    assert!(whole < exact && whole > 0.98 * exact, "{whole} {exact}");
    std::fs::remove_dir_all(root).unwrap();
}

#[test]
fn fewer_triangles_enclose_the_same() {
    // A ball of 0.3 m in 80 000 triangles.
    let (rings, sides) = (200_u32, 200_u32);
    let point = |i: u32, k: u32| {
        let (a, b) = (
            core::f64::consts::PI * f64::from(i) / f64::from(rings),
            core::f64::consts::TAU * f64::from(k % sides) / f64::from(sides),
        );
        [0.3 * a.sin() * b.cos(), 0.3 * a.sin() * b.sin(), -0.3 * a.cos()]
    };
    let faces = (0..rings).flat_map(|i| (0..sides).map(move |k| (i, k)));
    let all: Vec<_> = faces
        .flat_map(|(i, k)| {
            let [a, b, c, d] = [point(i, k), point(i, k + 1), point(i + 1, k + 1), point(i + 1, k)];
            [[a, b, c], [a, c, d]]
        })
        .collect();
    let (root, robot) =
        folder("fewer", r#"<visual><geometry><mesh filename="ball.stl"/></geometry></visual>"#);
    std::fs::write(root.join("arm/urdf/ball.stl"), stl_of(&all)).unwrap();
    let look = robot.look(3000, None);
    let shape = &look.shapes[0];
    assert_eq!(look.triangles_read, 80_000);
    assert!((1500..=3000).contains(&shape.triangles.len()), "{}", shape.triangles.len());
    let radius = |p: &[f64; 3]| p.iter().map(|x| x * x).sum::<f64>().sqrt();
    assert!(shape.points.iter().all(|p| (radius(p) - 0.3).abs() < 0.006));
    let exact = 4.0 / 3.0 * core::f64::consts::PI * 0.027;
    assert!((volume(shape) / exact - 1.0).abs() < 0.03, "{}", volume(shape) / exact);
    assert_eq!(look, robot.look(3000, None));
    std::fs::remove_dir_all(root).unwrap();
}

#[test]
fn what_cannot_be_read_is_told() {
    let (root, robot) = folder("missing", "");
    std::fs::write(root.join("other/secret.stl"), stl_of(&triangles())).unwrap();
    std::fs::write(root.join("arm/urdf/cut.stl"), &stl_of(&triangles())[..500]).unwrap();
    std::fs::write(root.join("arm/urdf/secret.txt"), "the secret").unwrap();
    let within = root.join("arm");
    let why = |named: &str, within: Option<&Path>| {
        std::fs::write(root.join("arm/urdf/rod.urdf"), urdf(&visual(named))).unwrap();
        let look = robot.look(100, within);
        assert!(look.shapes.is_empty(), "{named}");
        let [(link, why)] = &look.missing[..] else { panic!("{named}: {look:?}") };
        assert_eq!(link, "rod");
        assert!(!why.contains("the secret"), "{why}");
        why.clone()
    };
    for named in ["none.stl", "package://nobody/none.stl", "/dev/zero", "file:///etc/none.dae"] {
        assert!(why(named, None).starts_with(named), "{named}");
    }
    for outside in ["../../other/secret.stl", "package://other/secret.stl"] {
        assert!(why(outside, Some(&within)).contains("no such file"), "{outside}");
    }
    #[cfg(unix)]
    {
        let link = root.join("arm/urdf/link.stl");
        std::os::unix::fs::symlink(root.join("other/secret.stl"), link).unwrap();
        assert!(why("link.stl", Some(&within)).contains("no such file"));
    }
    why("cut.stl", None);
    why("secret.txt", None);
    why("../urdf", None);
    std::fs::remove_dir_all(root).unwrap();
}

#[test]
fn bytes_of_nobody() {
    let (root, robot) = folder("bytes", "");
    let mut state = 1_u64;
    let mut dice = |n: usize| {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        usize::try_from(state % n as u64).unwrap()
    };
    let deep = "<a>".repeat(100_000).into_bytes();
    for (name, bytes) in [
        ("a.stl", stl_of(&triangles())),
        ("b.stl", words().into_bytes()),
        ("c.obj", obj().into_bytes()),
        ("d.dae", collada().into_bytes()),
        ("e.dae", deep),
    ] {
        std::fs::write(root.join("arm/urdf/rod.urdf"), urdf(&visual(name))).unwrap();
        for _ in 0..if bytes.len() > 100_000 { 1 } else { 300 } {
            let mut changed = bytes.clone();
            for _ in 0..=dice(6) {
                let at = dice(changed.len());
                match dice(4) {
                    0 => changed[at] = u8::try_from(dice(256)).unwrap(),
                    1 => changed.truncate(at.max(1)),
                    2 => changed[at] = b"0123456789-e.< >"[dice(16)],
                    _ => changed.extend_from_slice(&bytes[at.min(bytes.len() - 1)..]),
                }
            }
            std::fs::write(root.join("arm/urdf").join(name), changed).unwrap();
            let look = robot.look(50, None);
            for shape in &look.shapes {
                assert!(shape.points.iter().flatten().all(|x| x.is_finite()));
                assert!(shape.triangles.iter().flatten().all(|c| *c < shape.points.len()));
            }
            assert!(look.shapes.iter().map(|s| s.triangles.len()).sum::<usize>() <= 50);
        }
    }
    std::fs::remove_dir_all(root).unwrap();
}
