//! A studio of a small study, and a client that sends whatever bytes it is given.

use std::io::{BufRead as _, BufReader, ErrorKind, Read as _, Write as _};
use std::net::{SocketAddr, TcpStream};
use std::path::{Path, PathBuf};
use std::time::Duration;

use phihat_studio::StudioOptions;

/// Longest wait of a test for an event: only one that never comes takes longer.
const PATIENCE: Duration = Duration::from_mins(10);

/// From one look to the next: seldom enough that the studio answers each.
const TICK: Duration = Duration::from_millis(50);

/// Looks again and again until something is there.
pub(crate) fn wait_for<T>(what: &str, mut look: impl FnMut() -> Option<T>) -> T {
    let looks = PATIENCE.as_millis() / TICK.as_millis();
    for _ in 0..looks {
        if let Some(found) = look() {
            return found;
        }
        std::thread::sleep(TICK);
    }
    panic!("waited for ten minutes, in vain: {what}");
}

/// A planar arm with stated gains, an encoder and its own push.
pub(crate) const STUDY: &str = r#"
title = "A planar arm"
duration_s = 1.0
seed = 5
[robot]
name = "planar3r"
[spec]
settle_s = 0.5
error_bound_rad = 2e-3
[gains]
order = 1
bandwidth_rad_s = 20.0
estimator_bandwidth_rad_s = 70.0
inertia_kg_m2 = [0.42, 0.18, 0.14]
[loop]
rate_hz = 1000.0
delay_samples = 1
[sensor]
encoder_bits = 18
velocity = "differenced"
[world]
friction = "robot"
payload = { mass_kg = 0.3 }
[[world.push]]
joint = "joint2"
torque_nm = 1.0
start_s = 0.2
duration_s = 0.1
[reference]
kind = "sines"
center = "ready"
fade_in_s = 0.5
[[reference.sine]]
amplitude_rad = 0.2
frequency_hz = 0.3
"#;

/// A studio that serves until the tests end.
pub(crate) struct Place {
    pub(crate) address: SocketAddr,
    pub(crate) key: String,
    pub(crate) folder: PathBuf,
}

/// A fresh folder with the study in it.
pub(crate) fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(env!("CARGO_PKG_NAME")).join(name);
    if folder.exists() {
        std::fs::remove_dir_all(&folder).unwrap();
    }
    std::fs::create_dir_all(folder.join("inside")).unwrap();
    let folder = folder.join("inside");
    std::fs::write(folder.join("arm.toml"), STUDY).unwrap();
    folder
}

/// A studio in a folder of its own.
pub(crate) fn place(name: &str) -> Place {
    let folder = folder(name);
    let study = Some(folder.join("arm.toml"));
    serve(&folder, StudioOptions { study, ..StudioOptions::default() })
}

/// A studio that works in a folder.
pub(crate) fn serve(folder: &Path, options: StudioOptions) -> Place {
    let options = StudioOptions { folder: folder.to_owned(), port: 0, ..options };
    let studio = options.open().unwrap();
    let (address, link) = (studio.address(), studio.link());
    let key = link.split("key=").nth(1).unwrap().to_owned();
    std::thread::spawn(move || studio.serve());
    Place { address, key, folder: folder.to_owned() }
}

impl Place {
    pub(crate) fn connect(&self) -> TcpStream {
        let stream = TcpStream::connect(self.address).unwrap();
        stream.set_read_timeout(Some(PATIENCE)).unwrap();
        stream.set_write_timeout(Some(PATIENCE)).unwrap();
        stream
    }

    /// Sends bytes, and reads until the other side closes; what came, whether or not all was taken.
    pub(crate) fn send(&self, bytes: &[u8]) -> String {
        let mut stream = self.connect();
        // Whoever refuses closes before all is sent.
        let _ = stream.write_all(bytes);
        let mut all = Vec::new();
        let mut some = [0; 4096];
        loop {
            match stream.read(&mut some) {
                Ok(0) => break,
                Ok(count) => all.extend_from_slice(&some[..count]),
                Err(why) if why.kind() == ErrorKind::Interrupted => {}
                Err(why) if matches!(why.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut) => {
                    panic!("waited for ten minutes, in vain: the studio closes a connection")
                }
                // It was closed with bytes unread.
                Err(_) => break,
            }
        }
        String::from_utf8_lossy(&all).into_owned()
    }

    /// The head of a request of our page.
    pub(crate) fn head(&self, line: &str) -> String {
        let Self { address, key, .. } = self;
        format!(
            "{line} HTTP/1.1\r\nHost: {address}\r\nConnection: close\r\nx-phihat-key: {key}\r\n"
        )
    }

    /// A request of our page, with a document.
    pub(crate) fn post(&self, path: &str, body: &str) -> String {
        let head = self.head(&format!("POST {path}"));
        let length = body.len();
        self.send(
            format!(
                "{head}Content-Type: application/json\r\nContent-Length: {length}\r\n\r\n{body}"
            )
            .as_bytes(),
        )
    }

    /// The first of the next pictures of the run that is as it shall be.
    pub(crate) fn picture(
        &self,
        is_it: impl Fn(&serde_json::Value) -> bool,
    ) -> Option<serde_json::Value> {
        let mut stream = self.connect();
        stream.write_all(format!("{}\r\n", self.head("GET /live")).as_bytes()).unwrap();
        let lines = BufReader::new(stream).lines().map_while(Result::ok);
        let pictures =
            lines.filter_map(|line| serde_json::from_str(line.strip_prefix("data: ")?).ok());
        pictures.take(20).find(|shown| is_it(shown))
    }

    pub(crate) fn get(&self, path: &str) -> String {
        self.send(format!("{}\r\n", self.head(&format!("GET {path}"))).as_bytes())
    }
}

/// Status of an answer; 0: the connection was closed without one.
pub(crate) fn status(answer: &str) -> u16 {
    answer.split(' ').nth(1).and_then(|word| word.parse().ok()).unwrap_or(0)
}

/// The document of an answer.
pub(crate) fn document(answer: &str) -> serde_json::Value {
    let body = answer.split_once("\r\n\r\n").unwrap().1;
    serde_json::from_str(body).unwrap_or_else(|why| panic!("{why}\n{answer}"))
}
