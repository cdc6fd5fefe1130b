//! A second studio of a project joins the first: a file among those of the person names its port and its token.

use std::fs;
use std::io::{Read, Write};
use std::net::{Ipv4Addr, SocketAddr, TcpStream};
use std::path::{Path, PathBuf};
use std::time::Duration;

use blocksim_diagram::fingerprint;
use blocksim_recording::limited_text;
use blocksim_studio::{Token, address as address_of};
use serde_json::{Value, json};

use crate::home;

/// How long a studio may take to answer.
const PATIENCE: Duration = Duration::from_millis(500);
/// Longest such file, bytes.
const LONGEST: u64 = 4096;

/// That a studio runs, until it ends.
pub struct Joined(Option<PathBuf>);

impl Joined {
    /// Tells others of it. Where that cannot be written, there will be two.
    pub fn tell(root: &Path, port: u16, token: &Token) -> Joined {
        let Some(file) = file(root) else { return Joined(None) };
        let text = json!({ "port": port, "token": token.text() }).to_string();
        Joined(write(&file, &text).is_ok().then_some(file))
    }
}

impl Drop for Joined {
    fn drop(&mut self) {
        if let Some(file) = &self.0 {
            let _ = fs::remove_file(file);
        }
    }
}

/// The address of a studio of this project that answers.
pub fn address(root: &Path) -> Option<String> {
    let text = limited_text(&file(root)?, LONGEST).ok()?;
    let told: Value = serde_json::from_str(&text).ok()?;
    let port = u16::try_from(told["port"].as_u64()?).ok()?;
    let token = Token::known(told["token"].as_str()?)?;
    answers(port, &token).then(|| address_of(port, &token))
}

/// Whether the studio there knows the token.
fn answers(port: u16, token: &Token) -> bool {
    let asked = || -> std::io::Result<String> {
        let mut stream =
            TcpStream::connect_timeout(&SocketAddr::from((Ipv4Addr::LOCALHOST, port)), PATIENCE)?;
        stream.set_read_timeout(Some(PATIENCE))?;
        let path = format!("/?token={}", token.text());
        write!(stream, "GET {path} HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nConnection: close\r\n\r\n")?;
        let mut answer = String::new();
        stream.take(LONGEST).read_to_string(&mut answer)?;
        Ok(answer)
    };
    asked().is_ok_and(|answer| answer.starts_with("HTTP/1.1 303") && answer.contains(token.text()))
}

fn file(root: &Path) -> Option<PathBuf> {
    let root = root.canonicalize().ok()?;
    let name = fingerprint(root.as_os_str().as_encoded_bytes()).replace(':', "-");
    Some(home::cache()?.join("studio").join(format!("{name}.json")))
}

/// Writes a file that nobody else may read.
fn write(file: &Path, text: &str) -> std::io::Result<()> {
    if let Some(folder) = file.parent() {
        fs::create_dir_all(folder)?;
    }
    // One that was left behind keeps its rights, whatever they are.
    let _ = fs::remove_file(file);
    let mut options = fs::OpenOptions::new();
    options.write(true).create_new(true);
    #[cfg(unix)]
    std::os::unix::fs::OpenOptionsExt::mode(&mut options, 0o600);
    options.open(file)?.write_all(text.as_bytes())
}
