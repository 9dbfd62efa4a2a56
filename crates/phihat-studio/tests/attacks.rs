//! Attacks on a studio. Wrong if one of these requests were obeyed, returned a secret, left a file outside of the
//! working folder, or prevented an honest page from being answered afterwards.

use std::io::{ErrorKind, Read as _, Write as _};
use std::net::TcpStream;

use serde_json::json;

use crate::support::{Place, document, place, status, wait_for};

/// An attempt: its name, the whole request, and the answers that are right; 0: closed without one.
type Attempt = (&'static str, Vec<u8>, &'static [u16]);

/// Requests that are refused: by host, origin, key or method.
#[expect(clippy::too_many_lines, reason = "a list of attempts")]
fn strangers(place: &Place) -> Vec<Attempt> {
    let Place { address, key, .. } = place;
    let port = address.port();
    let with = |lines: &str| {
        format!("GET /state HTTP/1.1\r\nConnection: close\r\n{lines}\r\n").into_bytes()
    };
    let ours = format!("Host: {address}\r\nx-phihat-key: {key}\r\n");
    let host = |host: &str| with(&format!("Host: {host}\r\nx-phihat-key: {key}\r\n"));
    let page = |line: &str| with(&format!("{ours}{line}\r\n"));
    let post = |line: &str| {
        format!(
            "POST /run HTTP/1.1\r\nConnection: close\r\n{ours}Content-Length: \
            14\r\n{line}\r\n\r\n{{\"again\":true}}"
        )
        .into_bytes()
    };
    let method = |word: &str| {
        format!("{word} /state HTTP/1.1\r\nConnection: close\r\n{ours}\r\n").into_bytes()
    };
    vec![
        (
            "rebinding: a name that was made to point here",
            host(&format!("evil.example:{port}")),
            &[421],
        ),
        (
            "rebinding: our address as a label of another name",
            host(&format!("127.0.0.1.evil.example:{port}")),
            &[421],
        ),
        ("rebinding: this address, another port", host("127.0.0.1:80"), &[421]),
        ("rebinding: no port", host("127.0.0.1"), &[421]),
        (
            "rebinding: the address written as one number",
            host(&format!("2130706433:{port}")),
            &[421],
        ),
        ("rebinding: the address of all interfaces", host(&format!("0.0.0.0:{port}")), &[421]),
        ("no host", with(&format!("x-phihat-key: {key}\r\n")), &[421, 400]),
        ("two hosts", with(&format!("{ours}Host: evil.example\r\n")), &[421, 400]),
        (
            "absolute target of another host",
            format!(
                "GET http://evil.example/state HTTP/1.1\r\nConnection: \
            close\r\n{ours}\r\n"
            )
            .into_bytes(),
            &[421],
        ),
        ("no key", with(&format!("Host: {address}\r\n")), &[403]),
        ("an empty key", with(&format!("Host: {address}\r\nx-phihat-key:\r\n")), &[403]),
        (
            "half of the key",
            with(&format!("Host: {address}\r\nx-phihat-key: {}\r\n", &key[..16])),
            &[403],
        ),
        ("two keys", page("x-phihat-key: 0"), &[403]),
        ("page of another origin", page("Origin: https://evil.example"), &[403]),
        ("page of no origin", page("Origin: null"), &[403]),
        ("page of our name behind TLS", page(&format!("Origin: https://{address}")), &[403]),
        (
            "two origins",
            page(&format!("Origin: http://{address}\r\nOrigin: http://evil.example")),
            &[403],
        ),
        ("another site, says the browser", page("Sec-Fetch-Site: cross-site"), &[403]),
        (
            "another port of this machine, says the browser",
            page("Sec-Fetch-Site: same-site"),
            &[403],
        ),
        (
            "EventSource of another origin",
            format!(
                "GET /live?key={key} HTTP/1.1\r\nConnection: close\r\nHost: \
            {address}\r\nOrigin: http://evil.example\r\nAccept: text/event-stream\r\n\r\n"
            )
            .into_bytes(),
            &[403],
        ),
        (
            "WebSocket of another origin",
            page(
                "Origin: http://evil.example\r\nUpgrade: websocket\r\nSec-WebSocket-Key: \
            AAAAAAAAAAAAAAAAAAAAAA==\r\nSec-WebSocket-Version: 13",
            ),
            &[403],
        ),
        (
            "POST of another origin",
            post("Content-Type: application/json\r\nOrigin: http://evil.example"),
            &[403],
        ),
        ("POST of a form", post("Content-Type: application/x-www-form-urlencoded"), &[415]),
        ("POST of plain text, which needs no leave", post("Content-Type: text/plain"), &[415]),
        ("POST without a type", post("Accept: */*"), &[415]),
        ("asking for leave across origins", method("OPTIONS"), &[405]),
        ("DELETE", method("DELETE"), &[405]),
        ("PUT", method("PUT"), &[405]),
        ("TRACE", method("TRACE"), &[405]),
        (
            "CONNECT",
            format!(
                "CONNECT 169.254.169.254:80 HTTP/1.1\r\nHost: {address}\r\nConnection: \
            close\r\n\r\n"
            )
            .into_bytes(),
            &[421, 405, 400],
        ),
        ("a method of nobody's", method("BREW"), &[405]),
    ]
}

/// Ways to files that are not served.
fn traversals(place: &Place) -> Vec<Attempt> {
    let get = |path: &str| format!("{}\r\n", place.head(&format!("GET {path}"))).into_bytes();
    [
        ("traversal", "/../secret.toml"),
        ("encoded traversal", "/%2e%2e/secret.toml"),
        ("encoded slashes", "/..%2f..%2fsecret.toml"),
        ("twice encoded", "/%252e%252e%252fsecret.toml"),
        ("backslashes", "/..\\secret.toml"),
        ("two slashes", "//etc/passwd"),
        ("behind an asset", "/studio.js/../../secret.toml"),
        ("a byte of nothing", "/studio.js%00.toml"),
        ("overlong UTF-8", "/%c0%ae%c0%ae/secret.toml"),
        ("the study's own file", "/arm.toml"),
    ]
    .map(|(name, path)| (name, get(path), &[404_u16, 400][..]))
    .into()
}

/// Bytes that are no request, or too large a one.
#[expect(clippy::too_many_lines, reason = "a list of attempts")]
fn malformed(place: &Place) -> Vec<Attempt> {
    let ours = place.head("GET /state");
    let post = place.head("POST /meet") + "Content-Type: application/json\r\n";
    let bytes = |text: String| text.into_bytes();
    vec![
        ("bytes of nobody's protocol", vec![0xff; 300], &[400, 0]),
        (
            "the beginning of TLS",
            b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03\r\n\r\n".to_vec(),
            &[400, 0],
        ),
        (
            "the beginning of HTTP/2",
            b"PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n".to_vec(),
            &[400, 405, 421, 505, 0],
        ),
        (
            "a giant header",
            bytes(format!("{ours}x-large: {}\r\n\r\n", "a".repeat(1 << 20))),
            &[431, 400, 0],
        ),
        (
            "a giant address",
            bytes(format!("GET /{} HTTP/1.1\r\n\r\n", "a".repeat(1 << 20))),
            &[414, 431, 400, 0],
        ),
        (
            "a thousand headers",
            bytes(format!("{ours}{}\r\n", "a: b\r\n".repeat(1000))),
            &[431, 400, 0],
        ),
        (
            "a header with a bare line end",
            bytes(format!("{ours}a: b\nc: d\r\n\r\n")),
            &[200, 400, 0],
        ),
        (
            "a giant body that is told",
            bytes(format!("{post}Content-Length: 1099511627776\r\n\r\n{{")),
            &[413],
        ),
        (
            "a giant body that is not told",
            bytes(format!(
                "{post}Transfer-Encoding: chunked\r\n\r\n80000\r\n{}\r\n0\r\n\r\n",
                "a".repeat(0x8_0000)
            )),
            &[413, 0],
        ),
        ("a negative length", bytes(format!("{post}Content-Length: -1\r\n\r\n{{}}")), &[400]),
        (
            "two lengths",
            bytes(format!("{post}Content-Length: 2\r\nContent-Length: 40\r\n\r\n{{}}")),
            &[400],
        ),
        (
            "a length and chunks, which two readers cut apart differently",
            bytes(format!(
                "{post}Content-Length: 4\r\nTransfer-Encoding: chunked\r\n\r\n0\r\n\r\nGET /state HTTP/1.1\r\n\r\n"
            )),
            &[400],
        ),
        (
            "a chunk of no size",
            bytes(format!("{post}Transfer-Encoding: chunked\r\n\r\nzz\r\n{{}}\r\n0\r\n\r\n")),
            &[400, 413, 0],
        ),
    ]
}

/// Documents that are wrong: none is obeyed.
#[expect(clippy::too_many_lines, reason = "a list of attempts")]
fn documents() -> Vec<(&'static str, &'static str, String)> {
    let deep = "[".repeat(100_000);
    let meet = |size: &str| format!("{{\"what\":\"push\",\"joint\":1,\"size\":{size}}}");
    vec![
        ("no JSON", "/meet", "push!".into()),
        ("nothing", "/meet", String::new()),
        ("a list that never ends", "/meet", deep),
        ("a list in place of an object", "/meet", "[1]".into()),
        (
            "a key of nobody's",
            "/meet",
            r#"{"what":"push","joint":1,"size":1,"file":"/etc/passwd"}"#.into(),
        ),
        ("not a number", "/meet", meet("NaN")),
        ("infinite", "/meet", meet("Infinity")),
        ("beyond all numbers", "/meet", meet("1e999")),
        ("huge", "/meet", meet("1e300")),
        ("a number in quotes", "/meet", meet("\"1\"")),
        ("a list of numbers", "/meet", meet("[1,2,3,4]")),
        ("no such joint", "/meet", r#"{"what":"push","joint":3,"size":1}"#.into()),
        (
            "a joint beyond all numbers",
            "/meet",
            r#"{"what":"push","joint":18446744073709551616,"size":1}"#.into(),
        ),
        ("a negative joint", "/meet", r#"{"what":"push","joint":-1,"size":1}"#.into()),
        ("no such fault", "/meet", r#"{"what":"sensor_nan","joint":1,"size":1}"#.into()),
        ("a negative mass", "/meet", r#"{"what":"payload","joint":null,"size":-1}"#.into()),
        ("half a surrogate", "/meet", r#"{"what":"\ud800","joint":1,"size":1}"#.into()),
        ("faster than any clock", "/run", r#"{"speed":1e9}"#.into()),
        ("time backwards", "/run", r#"{"speed":-1}"#.into()),
        ("gains of nothing", "/gains", r#"{"error":1,"outer":0,"estimator":1,"inertia":1}"#.into()),
        (
            "an error of nothing",
            "/gains",
            r#"{"error":0,"outer":1,"estimator":1,"inertia":1}"#.into(),
        ),
        ("name with a way up", "/save", r#"{"name":"../out"}"#.into()),
        ("name with a root", "/save", r#"{"name":"/tmp/out"}"#.into()),
        ("name of a hidden file", "/save", r#"{"name":".bashrc"}"#.into()),
        ("name with an end in it", "/save", r#"{"name":"out\u0000"}"#.into()),
        ("name of no letters", "/save", r#"{"name":""}"#.into()),
        ("name longer than a disk takes", "/save", json!({ "name": "a".repeat(5000) }).to_string()),
        ("in place of the study", "/save", r#"{"name":"arm"}"#.into()),
        (
            "robot from the system",
            "/open",
            json!({ "text": "[robot]\nfile = \"/etc/passwd\"" }).to_string(),
        ),
        (
            "robot from above",
            "/check",
            json!({ "text": "[robot]\nfile = \"../secret.toml\"" }).to_string(),
        ),
        (
            "robot from nowhere above",
            "/check",
            json!({ "text": "[robot]\nfile = \"../nowhere.toml\"" }).to_string(),
        ),
        (
            "trace from the network",
            "/check",
            json!({ "text": "[design]\ninertia_from = \"http://evil.example/t.csv\"" }).to_string(),
        ),
    ]
}

/// An honest page is answered, as soon as there is room: the state that it is told.
fn still_serves(place: &Place, after: &str) -> serde_json::Value {
    wait_for(&format!("an answer to an honest page after {after}"), || {
        let answer = place.get("/state");
        (status(&answer) == 200).then(|| document(&answer))
    })
}

/// Connects 500 times and sends nothing: the connections, and how many of them are open. `None`: the first one is
/// not open any more.
///
/// Connections are taken in their order, and one beyond the bound is closed at once: when the last one is closed,
/// all have been taken, and the first ones still have time to send something. Without a bound the first would be
/// given up before the last.
fn crowd(place: &Place) -> Option<(Vec<TcpStream>, usize)> {
    let all: Vec<_> = (0..500).map(|_| place.connect()).collect();
    let mut byte = [0];
    let (Some(first), Some(mut last)) = (all.first(), all.last()) else { return None };
    assert_eq!(last.read(&mut byte).unwrap(), 0, "the last one is closed");
    let is_open = |mut stream: &TcpStream| {
        stream.set_nonblocking(true).unwrap();
        stream.read(&mut [0]).is_err_and(|why| why.kind() == ErrorKind::WouldBlock)
    };
    if !is_open(first) {
        return None;
    }
    let open = all.iter().filter(|stream| is_open(stream)).count();
    Some((all, open))
}

#[test]
fn requests_that_are_not_obeyed() {
    let place = place("attacks");
    let secret = place.folder.parent().unwrap().join("secret.toml");
    std::fs::write(&secret, "title = \"the secret\"").unwrap();
    let before = std::fs::read_dir(place.folder.parent().unwrap()).unwrap().count();
    let mut tried = 0;
    for (name, bytes, right) in [strangers(&place), traversals(&place), malformed(&place)].concat()
    {
        let answer = place.send(&bytes);
        let got = status(&answer);
        assert!(right.contains(&got), "{name}: {got}, not one of {right:?}\n{answer}");
        assert!(!answer.contains("the secret") && !answer.contains("root:"), "{name}: {answer}");
        assert!(got == 200 || !answer.contains(&place.key), "{name}: tells the key");
        tried += 1;
    }
    for (name, path, body) in documents() {
        let answer = place.post(path, &body);
        assert!((400..500).contains(&status(&answer)), "{name}: {answer}");
        assert!(!answer.contains("the secret") && !answer.contains("root:"), "{name}: {answer}");
        tried += 1;
    }
    still_serves(&place, "all requests");
    let state = place.get("/state");
    assert!(state.contains("content-security-policy: default-src 'none'"), "{state}");
    let after = std::fs::read_dir(place.folder.parent().unwrap()).unwrap().count();
    assert_eq!((before, std::fs::read_dir(&place.folder).unwrap().count()), (after, 1));
    println!("{tried} requests tried");
    assert!(tried >= 80);
}

#[cfg(unix)]
#[test]
fn links_lead_nowhere() {
    let place = place("links");
    let above = place.folder.parent().unwrap();
    std::fs::write(above.join("secret.urdf"), "<robot name=\"the secret\"/>").unwrap();
    let link = |to: &str, name: &str| {
        std::os::unix::fs::symlink(above.join(to), place.folder.join(name)).unwrap();
    };
    link("secret.urdf", "arm.urdf");
    link("made.toml", "linked.toml");
    link(".", "up");
    for file in ["arm.urdf", "up/secret.urdf"] {
        let text = json!({ "text": format!("[robot]\nfile = \"{file}\"") }).to_string();
        let answer = place.post("/check", &text);
        assert!(
            status(&answer) == 422 && answer.contains("outside of the working folder"),
            "{answer}"
        );
    }
    assert_eq!(status(&place.post("/save", r#"{"name":"linked"}"#)), 422);
    assert!(!above.join("made.toml").exists());
}

/// A mesh that a page asks for by a study's text is read inside of the working folder alone, through links too.
#[cfg(unix)]
#[test]
fn meshes_are_read_inside_alone() {
    let place = place("meshes");
    let above = place.folder.parent().unwrap();
    let mesh = "v 0 0 0\nv 0.1 0 0\nv 0 0.1 0\nf 1 2 3\n";
    std::fs::write(above.join("secret.obj"), mesh).unwrap();
    std::fs::write(place.folder.join("own.obj"), mesh).unwrap();
    std::os::unix::fs::symlink(above.join("secret.obj"), place.folder.join("link.obj")).unwrap();
    let robots = concat!(env!("CARGO_MANIFEST_DIR"), "/../phihat-model/robots/planar3r");
    let urdf = std::fs::read_to_string(format!("{robots}.urdf")).unwrap();
    std::fs::copy(format!("{robots}.toml"), place.folder.join("planar3r.toml")).unwrap();
    let study = crate::support::STUDY.replace("name = \"planar3r\"", "file = \"planar3r.toml\"");
    for (file, shapes) in [("own.obj", 1), ("../secret.obj", 0), ("link.obj", 0)] {
        let visual = format!("<visual><geometry><mesh filename=\"{file}\"/></geometry></visual>");
        let (before, after) = urdf.split_once("<link name=\"link1\">").unwrap();
        let text = format!("{before}<link name=\"link1\">{visual}{after}");
        std::fs::write(place.folder.join("planar3r.urdf"), text).unwrap();
        let answer = place.post("/open", &json!({ "text": study }).to_string());
        assert_eq!(status(&answer), 200, "{answer}");
        let state = document(&place.get("/state"));
        let found = state["arm"]["shapes"].as_array().map_or(0, Vec::len);
        assert_eq!(found, shapes, "{file}");
    }
}

#[test]
fn slow_and_many_clients_are_bounded() {
    let place = place("slow");
    // A head that never ends, a body that never comes, and nothing at all: each is given up.
    let head =
        place.head("POST /run") + "Content-Type: application/json\r\nContent-Length: 100\r\n\r\n{";
    for (name, bytes) in
        [("head", "GET / HTTP/1.1\r\nHost: "), ("body", head.as_str()), ("silence", "")]
    {
        let answer = place.send(bytes.as_bytes());
        assert!([0, 400, 408].contains(&status(&answer)), "slow {name}: {answer}");
    }
    // 500 connections: few stay open, and an honest page is answered when they are given up. A machine that was busy
    // with something else for longer than a connection may send nothing has another try.
    let tried = (0..10).find_map(|_| {
        still_serves(&place, "slow clients");
        crowd(&place)
    });
    let (all, open) = tried.expect("the first connection is given up before the last is refused");
    assert!(open <= 64, "{open} of 500 connections are kept");
    still_serves(&place, "many connections");
    drop(all);
    // Pages that look on, and read nothing after the first line; a ninth is refused.
    let looking: Vec<_> = (0..8)
        .map(|_| {
            let mut stream = place.connect();
            stream.write_all(format!("{}\r\n", place.head("GET /live")).as_bytes()).unwrap();
            let mut line = [0; 15];
            stream.read_exact(&mut line).unwrap();
            assert_eq!(line, *b"HTTP/1.1 200 OK");
            stream
        })
        .collect();
    assert_eq!(status(&place.get("/live")), 503);
    still_serves(&place, "pages that never read");
    drop(looking);
    // Faster than is answered.
    let answers: Vec<u16> = (0..1500).map(|_| status(&place.get("/nothing"))).collect();
    let refused = answers.iter().filter(|status| **status == 429).count();
    println!("{refused} of 1500 requests at once were too many");
    let state = still_serves(&place, "too many requests");
    assert!(state["joints"].is_array(), "{state}");
}
