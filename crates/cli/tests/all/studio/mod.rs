//! The studio as a person uses it, and as strangers would like to.

mod access;
mod analysis;
mod browser;
mod chapter;
mod edit;
mod film;
mod joints;
mod movement;
mod panel;
mod plugins;
mod results;
mod sequences;
mod sheets;
mod standing;
mod tabs;

use std::fs;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use self::browser::Page;
use crate::desk::Desk;

const SERVO: &str = r#"// A drive that follows a step.
Diagram(
    title: "Servo",
    simulation: (stop_time: "2 s"),
    blocks: {
        "demand": Step(time: "0.5 s", after: "90 deg"), // the target
        "error": Sum(signs: "+-"),
        "gain": Gain(k: "6 1/s"),
        "angle": Integrator(),
        "scope": Scope(inputs: ["set", "actual"], display: "deg"),
    },
    connections: ["demand.y -> error.u1, scope.set", "angle.y -> error.u2, scope.actual", "error.y -> gain.u", "gain.y -> angle.u"],
)
"#;

/// A studio that serves a folder.
struct Studio {
    child: Child,
    address: String,
}

impl Studio {
    fn of(desk: &Desk, arguments: &[&str]) -> Studio {
        let mut words = vec!["studio", "--no-open"];
        words.extend(arguments);
        if !words.contains(&"--port") {
            words.extend(["--port", "0"]);
        }
        // Its own settings, so that tests beside it do not join.
        let mut command = desk.command(&words);
        command.env("BLOCKSIM_HOME", desk.0.join("home"));
        Studio::start(&mut command)
    }

    fn start(command: &mut Command) -> Studio {
        let mut child = command.stdout(Stdio::piped()).stderr(Stdio::null()).spawn().expect("the program");
        let mut address = String::new();
        let out = child.stdout.take().expect("a pipe");
        BufReader::new(out).read_line(&mut address).expect("an address");
        assert!(address.starts_with("http://127.0.0.1:"), "{address:?}");
        Studio { child, address: address.trim().to_owned() }
    }

    fn port(&self) -> u16 {
        let rest = self.address.trim_start_matches("http://127.0.0.1:");
        rest.split('/').next().and_then(|port| port.parse().ok()).expect("a port")
    }

    fn token(&self) -> &str {
        self.address.split("token=").nth(1).expect("a token")
    }

    /// What the server answers to lines of a request.
    fn raw(&self, request: &[u8]) -> String {
        let mut stream = TcpStream::connect(("127.0.0.1", self.port())).expect("the server");
        stream.set_read_timeout(Some(Duration::from_secs(20))).expect("a limit");
        let _ = stream.write_all(request);
        let mut answer = Vec::new();
        let _ = stream.read_to_end(&mut answer);
        String::from_utf8_lossy(&answer).into_owned()
    }

    /// What it answers to the person who started it, but for what `headers` say.
    fn asked(&self, method: &str, path: &str, headers: &[(&str, &str)], body: &str) -> String {
        let port = self.port();
        let (host, cookie) = (format!("127.0.0.1:{port}"), format!("blocksim-{port}={}", self.token()));
        let mut all =
            vec![("Host", host.as_str()), ("Cookie", &cookie), ("X-Blocksim", "1"), ("Connection", "close")];
        for (name, value) in headers {
            all.retain(|(known, _)| known != name);
            all.push((name, value));
        }
        let lines: String = all
            .iter()
            .filter(|(_, value)| !value.is_empty())
            .map(|(name, value)| format!("{name}: {value}\r\n"))
            .collect();
        self.raw(
            format!("{method} {path} HTTP/1.1\r\n{lines}Content-Length: {}\r\n\r\n{body}", body.len())
                .as_bytes(),
        )
    }

    fn status(&self, method: &str, path: &str, headers: &[(&str, &str)], body: &str) -> u16 {
        let answer = self.asked(method, path, headers, body);
        answer
            .split(' ')
            .nth(1)
            .and_then(|status| status.parse().ok())
            .unwrap_or_else(|| panic!("{answer:?}"))
    }

    /// Ctrl-C, and how the program ends.
    fn interrupt(mut self) -> Option<i32> {
        let sent = Command::new("kill").args(["-INT", &self.child.id().to_string()]).status();
        assert!(sent.expect("kill").success());
        let status = self.child.wait().expect("an end");
        status.code()
    }
}

impl Drop for Studio {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

#[test]
fn strangers_are_not_answered() {
    let desk = Desk::with(&[("servo.ron", SERVO)]);
    let studio = Studio::of(&desk, &[]);
    assert_eq!(studio.status("GET", "/", &[], ""), 200);
    assert_eq!(studio.status("GET", "/api/project", &[], ""), 200);
    let evil = [
        ("Cookie", "x=y"),
        ("Host", "evil.example"),
        ("Origin", "http://evil.example"),
        ("Origin", "null"),
        ("Sec-Fetch-Site", "cross-site"),
    ];
    for header in evil {
        for path in ["/", "/api/project", "/api/news", "/assets/studio.js", "/nothing"] {
            assert_eq!(studio.status("GET", path, &[header], ""), 403, "{header:?} {path}");
        }
        assert_eq!(studio.status("POST", "/api/run", &[header], "{}"), 403, "{header:?}");
    }
    assert_eq!(studio.status("POST", "/api/run", &[("X-Blocksim", "")], "{}"), 403);
    assert!(!desk.0.join("runs").exists(), "nothing was run");
    let told = studio.asked("GET", "/", &[("Cookie", "x=y")], "");
    assert!(told.contains("open the whole address that `blocksim studio` has printed"), "{told}");
}

#[test]
fn nothing_outside_of_the_project_is_shown_and_nothing_is_written_unless_it_may_be() {
    let desk = Desk::with(&[("servo.ron", SERVO)]);
    fs::create_dir_all(desk.0.join("secret")).expect("a folder");
    fs::write(desk.0.join("secret/manifest.json"), "{}").expect("a file");
    let studio = Studio::of(&desk, &[]);
    for path in [
        "/runs/..%2fsecret",
        "/runs/../secret",
        "/runs/.",
        "/runs/..",
        "/runs/",
        "/runs/%00",
        "/assets/..%2f..%2fCargo.toml",
        "/api/../servo.ron",
    ] {
        let status = studio.status("GET", path, &[], "");
        assert!(status == 404 || status == 400, "{path}: {status}");
    }
    let set = r#"{"target": "gain.k", "value": "9 1/s"}"#;
    let told = studio.asked("POST", "/api/set", &[], set);
    assert!(told.starts_with("HTTP/1.1 409") && told.contains("--edit"), "{told}");
    assert_eq!(desk.read("servo.ron"), SERVO);
    assert_eq!(studio.status("DELETE", "/", &[], ""), 405);
    let elsewhere = r#"{"model": "/etc/passwd"}"#;
    assert!(studio.asked("POST", "/api/model", &[], elsewhere).contains("there is no such model"));
}

#[test]
fn whatever_is_sent_the_server_goes_on() {
    let desk = Desk::with(&[("servo.ron", SERVO)]);
    let studio = Studio::of(&desk, &["--edit"]);
    let mut random = 7_u64;
    let mut next = |below: u64| {
        random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (random >> 33) % below
    };
    let bodies = [
        "",
        "{",
        "[]",
        "null",
        "{\"do\": 3}",
        "{\"target\": \"\", \"value\": \"\"}",
        "{\"target\": \"gain.k\", \"value\": \"\\u0000\"}",
        "{\"set\": [1, {}], \"speed\": \"x\"}",
        "{\"do\": \"delete\", \"blocks\": [\"gain\"], \"version\": 0}",
        "{\"do\": \"add\", \"kind\": [], \"level\": 1, \"parameters\": [], \"into\": {}}",
        "{\"file\": \"../servo.ron\", \"text\": \"\", \"base\": \"\", \"at\": -1}",
        "{\"file\": \"servo.ron\", \"text\": \"(((\", \"base\": \"x\", \"at\": 1e99}",
        "{\"kind\": \"Gain\", \"level\": \"a/b\", \"words\": \"\\u0000\"}",
        "\u{feff}{}",
    ];
    let paths = [
        "/",
        "/api/set",
        "/api/edit",
        "/api/save",
        "/api/text",
        "/api/draft",
        "/api/complete",
        "/api/kinds",
        "/api/kind",
        "/api/undo",
        "/api/redo",
        "/api/control",
        "/api/model",
        "/api/parameters",
        "/api/diagram",
        "/runs/x",
        "/api/%",
        "/assets/",
    ];
    for n in 0..1000 {
        let method = ["GET", "POST", "HEAD", "PUT", "G\u{e4}T", ""][next(6) as usize];
        let path = paths[next(paths.len() as u64) as usize];
        let body = bodies[next(bodies.len() as u64) as usize];
        if n % 4 == 0 {
            // Damaged requests, cut anywhere, are closed at once.
            let whole = format!(
                "{method} {path} HTTP/1.1\r\nHost: 127.0.0.1:{}\r\nContent-Length: 99999999999\r\n\r\n{body}",
                studio.port()
            );
            let mut stream = TcpStream::connect(("127.0.0.1", studio.port())).expect("the server");
            let _ = stream.write_all(&whole.as_bytes()[..next(whole.len() as u64) as usize]);
            continue;
        }
        studio.asked(if method.is_empty() { "POST" } else { method }, path, &[], body);
    }
    assert_eq!(studio.status("GET", "/api/project", &[], ""), 200);
    assert_eq!(desk.read("servo.ron"), SERVO);
}

#[test]
fn a_second_studio_joins_the_first_and_ctrl_c_ends_it() {
    let desk = Desk::with(&[("servo.ron", SERVO)]);
    let studio = Studio::of(&desk, &[]);
    let mut second = desk.command(&["studio", "--no-open"]);
    let second = second.env("BLOCKSIM_HOME", desk.0.join("home")).output().expect("the program");
    assert_eq!(String::from_utf8_lossy(&second.stdout).trim(), studio.address);
    assert!(String::from_utf8_lossy(&second.stderr).contains("runs already"));
    assert_eq!(studio.interrupt(), Some(0));
    // The next one finds nobody to join.
    let third = Studio::of(&desk, &[]);
    assert_eq!(third.status("GET", "/api/project", &[], ""), 200);
}

#[test]
fn what_cannot_be_served_is_explained() {
    let desk = Desk::with(&[("notes.txt", "none")]);
    let told = desk.said(&["studio", "--no-open"]);
    assert!(told.contains("there are no models in `.`") && told.contains("blocksim new NAME"), "{told}");
    let desk = Desk::with(&[("servo.ron", SERVO)]);
    let taken = std::net::TcpListener::bind(("127.0.0.1", 0)).expect("a port");
    let port = taken.local_addr().expect("an address").port().to_string();
    let told = desk.said(&["studio", "--no-open", "--port", &port]);
    assert!(told.contains("no page can be served at port") && told.contains("--port 0"), "{told}");
    let told = desk.said(&["studio", "missing.ron"]);
    assert!(told.contains("missing.ron") && told.contains("the file does not exist"), "{told}");
}

/// A page that shows the project of a studio.
fn shown(studio: &Studio) -> Option<Page> {
    let mut page = Page::new()?;
    page.open(&studio.address);
    page.until("document.documentElement.dataset.ready === 'true'");
    Some(page)
}

#[test]
fn a_run_fills_scopes_and_leaves_what_the_command_leaves() {
    let desk = Desk::with(&[("servo.ron", SERVO)]);
    let studio = Studio::of(&desk, &[]);
    let Some(mut page) = shown(&studio) else { return };
    assert_eq!(page.value("document.title"), "Servo – blocksim");
    page.key("F5");
    page.until("document.querySelector('.run-line').textContent.includes('2 s simulated')");
    page.until("R.Live.rows() > 20");
    // The last values of the scope, as its legend has them.
    page.until(
        "[...document.querySelectorAll('#plots .entry b')].map((b) => b.textContent).join() === '89.989,90'",
    );
    // All values on the wires of the diagram.
    page.value("location.hash = '#diagram'");
    page.until("[...document.querySelectorAll('#diagram-view .value')].some((text) => text.textContent === '89.99 °')");
    let runs = desk.names("runs");
    assert_eq!(runs.len(), 1, "{runs:?}");
    // Its page as a file in its folder; a name that leads elsewhere has none.
    page.value(&format!("location.hash = '#runs/{}'", runs[0]));
    page.until("document.querySelector('iframe.run-page')");
    page.value("[...document.querySelectorAll('#runs-view button')].find((one) => one.textContent === 'Write report.html').click()");
    page.until("document.querySelector('#runs-view .note').textContent.includes('report.html is written')");
    assert!(desk.read(&format!("runs/{}/report.html", runs[0])).contains("<title>Servo"));
    assert_eq!(studio.status("POST", "/api/report", &[], r#"{"run": "../.."}"#), 404);
    let by_command = desk.call(&["run", "servo.ron", "--out", "command", "--quiet"]);
    assert_eq!(by_command.code, Some(0), "{}", by_command.err);
    let recorded = |folder: &str| fs::read(desk.0.join(folder).join("signals.csv")).expect("signals");
    assert_eq!(recorded(&format!("runs/{}", runs[0])), recorded("command"), "the same to the bit");
    // The page of the run, in a frame that can reach nothing of the studio.
    page.value(&format!("location.hash = '#runs/{}'", runs[0]));
    page.until("document.querySelector('iframe')");
    page.until("document.querySelector('iframe').contentDocument === null");
    assert_eq!(page.complaints, Vec::<String>::new());
}

#[test]
fn a_parameter_is_changed_and_changed_back_and_wrong_ones_stay_where_they_were_typed() {
    let desk = Desk::with(&[("servo.ron", SERVO)]);
    let studio = Studio::of(&desk, &["--edit"]);
    let Some(mut page) = shown(&studio) else { return };
    page.value("location.hash = '#values'");
    let field = "document.querySelector('input[aria-label=\"gain.k\"]')";
    page.until(field);
    page.value(&format!("{field}.focus()"));
    page.replace("9 1/s");
    page.key("Enter");
    page.until("document.querySelector('.difference')?.textContent.includes('+        \"gain\": Gain(k: \"9 1/s\"),')");
    assert_eq!(desk.read("servo.ron"), SERVO.replace("6 1/s", "9 1/s"), "a small edit; comments stay");
    page.until(&format!("{field}?.value === '9 1/s'"));
    page.value("document.activeElement.blur(); R.Values.undo()");
    page.until(&format!("{field}?.value === '6 1/s'"));
    assert_eq!(desk.read("servo.ron"), SERVO);
    // A unit of something else.
    page.value(&format!("{field}.focus()"));
    page.replace("9 kg");
    page.key("Enter");
    page.until("document.querySelector('#values-view .answer .bad')");
    assert_eq!(page.value(&format!("{field}.value")), "9 kg");
    assert_eq!(desk.read("servo.ron"), SERVO);
    // For one run alone.
    page.value(&format!("{field}.focus()"));
    page.replace("3 1/s");
    page.value(&format!("{field}.closest('td').querySelectorAll('button')[1].click()"));
    page.until("document.querySelector('.run-line').textContent.includes('2 s simulated')");
    page.until(
        "[...document.querySelectorAll('#plots .entry b')].map((b) => b.textContent).join() === '89,90'",
    );
    assert_eq!(desk.read("servo.ron"), SERVO);
}

#[test]
fn what_is_saved_elsewhere_is_seen_at_once_with_its_problems() {
    let desk = Desk::with(&[("servo.ron", SERVO)]);
    let studio = Studio::of(&desk, &[]);
    let (Some(mut page), Some(mut other)) = (shown(&studio), shown(&studio)) else { return };
    page.value("location.hash = '#diagram'");
    page.until("document.querySelectorAll('#diagram-view [data-node]').length === 5");
    fs::write(
        desk.0.join("servo.ron"),
        SERVO.replace("\"gain\": Gain", "\"half\": Gain(k: 0.5), \"gain\": Gain"),
    )
    .expect("a file");
    page.until("document.querySelectorAll('#diagram-view [data-node]').length === 6");
    fs::write(desk.0.join("servo.ron"), SERVO.replace("gain.u", "gain.v")).expect("a file");
    page.until("document.querySelector('#problems .error')?.textContent.includes('has no input `v`')");
    // The table comes after the picture, and not at the same time to both pages.
    other.until("document.querySelector('#project-view .state.error')");
    other.until("document.querySelector('#project-view').innerText.includes('servo.ron:12')");
    fs::write(desk.0.join("servo.ron"), SERVO).expect("a file");
    page.until("!document.querySelector('#problems .error')");
    other.until("document.querySelector('#project-view .state.ready')");
    // An editor that empties a file before it writes it, and one that takes longer for that.
    fs::write(desk.0.join("servo.ron"), "").expect("a file");
    page.until(
        "document.querySelector('#problems .error')?.textContent.includes('there is nothing in this file')",
    );
    page.until("document.querySelectorAll('#diagram-view [data-node]').length === 0");
    fs::write(desk.0.join("servo.ron"), SERVO).expect("a file");
    page.until("document.querySelectorAll('#diagram-view [data-node]').length === 5");
    assert_eq!(page.value("document.getElementById('trouble').textContent"), "");
    assert_eq!([page.complaints.len(), other.complaints.len()], [0, 0], "{:?}", page.complaints);
}

#[test]
fn a_problem_is_fixed_by_a_press_and_a_parameter_is_found_from_its_block() {
    let desk = Desk::with(&[("servo.ron", &SERVO.replace("Integrator", "Intergrator"))]);
    let studio = Studio::of(&desk, &["--edit"]);
    let Some(mut page) = shown(&studio) else { return };
    page.until("document.querySelector('#project-view .problems button')");
    page.value("document.querySelector('#project-view .problems button').click()");
    page.until("document.querySelector('#project-view .state.ready') && !document.querySelector('#project-view .problems')");
    assert_eq!(desk.read("servo.ron"), SERVO);
    page.value("R.Values.undo()");
    page.until("document.querySelector('#project-view .problems button')");
    assert!(desk.read("servo.ron").contains("Intergrator"));
    fs::write(desk.0.join("servo.ron"), SERVO).expect("a file");
    page.until("document.querySelector('#project-view .state.ready')");
    // From a block of the diagram to its parameter.
    page.value("location.hash = '#diagram'");
    page.until("document.querySelectorAll('#diagram-view [data-node]').length === 5");
    page.value("R.Diagram.show('', 'gain')");
    page.until("document.querySelector('.inspector td button')?.textContent === 'k'");
    page.value("document.querySelector('.inspector td button').click()");
    page.until("document.querySelectorAll('#values-view tbody tr').length === 1 && document.querySelector('#values-view input[aria-label=\"gain.k\"]')");
    assert_eq!(page.complaints, Vec::<String>::new());
}

#[test]
fn a_key_that_is_pressed_twice_starts_one_run() {
    let desk = Desk::with(&[("servo.ron", SERVO)]);
    let studio = Studio::of(&desk, &[]);
    let Some(mut page) = shown(&studio) else { return };
    // How fast a run is to be is chosen before it as well.
    page.value("(() => { const speed = document.querySelector('select[aria-label=Speed]'); speed.value = '10'; speed.dispatchEvent(new Event('change')); })()");
    page.value("for (let n = 0; n < 3; n++) document.dispatchEvent(new KeyboardEvent('keydown', { key: 'F5', bubbles: true }))");
    page.until("document.querySelector('.run-line').textContent.includes('2 s simulated')");
    assert_eq!(page.complaints, Vec::<String>::new(), "nothing is asked that is refused");
    assert_eq!(fs::read_dir(desk.0.join("runs")).expect("runs").count(), 1);
}

/// A block that cannot go on is named behind the message, found in the diagram by a press, and marked there with what it is in.
#[test]
fn the_block_at_which_a_run_fails_is_shown() {
    let part = r#"Diagram(inputs: { "u": () }, outputs: { "y": "root.y" }, blocks: { "root": Function(function: Sqrt) },
        connections: ["in.u -> root.u"])"#;
    let model = r#"Diagram(simulation: (stop_time: "2 s"), blocks: { "falls": Ramp(slope: "-1 1/s", initial: 1),
        "part": Subsystem(file: "part.ron"), "show": Scope(inputs: ["y"]) },
        connections: ["falls.y -> part.u", "part.y -> show.y"])"#;
    let desk = Desk::with(&[("falls.ron", model), ("part.ron", part)]);
    let studio = Studio::of(&desk, &["falls.ron"]);
    let Some(mut page) = shown(&studio) else { return };
    page.key("F5");
    page.until("document.querySelector('.run-line.bad button')?.textContent === 'part/root'");
    page.value("document.querySelector('.run-line button').click()");
    page.until("location.hash === '#diagram' && R.Diagram.now().level?.path === 'part'");
    let marked = "[...document.querySelectorAll('.level .failed')].map((one) => one.getAttribute('aria-description')).join()";
    page.until(&format!("{marked} === 'the last run failed here'"));
    page.value("R.Diagram.go('', true)");
    page.until(&format!("R.Diagram.now().level.path === '' && {marked} === 'the last run failed here'"));
    // Another run begins without a mark.
    std::fs::write(desk.0.join("falls.ron"), model.replace("-1 1/s", "1 1/s")).expect("a model");
    page.until("R.Project.known().problems.length === 0");
    page.key("F5");
    page.until("/ s simulated/.test(document.querySelector('.run-line').textContent)");
    page.value("location.hash = '#diagram'");
    page.until(&format!("R.Diagram.now().level.path === '' && {marked} === ''"));
    assert!(page.complaints.is_empty(), "{:?}", page.complaints);
}

#[test]
fn a_run_can_be_paused_and_ended_and_what_it_recorded_is_kept() {
    let desk =
        Desk::with(&[("servo.ron", &SERVO.replace("\"2 s\"", "\"1000 s\", solver: Ode4(step: \"10 ms\")"))]);
    let studio = Studio::of(&desk, &[]);
    let Some(mut page) = shown(&studio) else { return };
    page.value("R.Desk.ask('run', { speed: 1 }).then(() => null)");
    page.value("location.hash = '#run'");
    page.until("R.Live.rows() > 3");
    page.key(" ");
    page.until("document.querySelector('.run-line').textContent.includes('paused')");
    std::thread::sleep(Duration::from_millis(300));
    let still = page.value("R.Live.rows()");
    std::thread::sleep(Duration::from_millis(300));
    assert_eq!(page.value("R.Live.rows()"), still);
    page.key("s");
    page.until(&format!("R.Live.rows() === {still} + 1"));
    page.key("Escape");
    page.until("document.querySelector('.run-line').textContent.includes('ended at')");
    let runs = desk.names("runs");
    assert_eq!(runs.len(), 1);
    assert!(desk.read(&format!("runs/{}/manifest.json", runs[0])).contains("interrupted"));
    // A run that goes on when the program is ended is kept as well.
    page.value("R.Desk.ask('run', { speed: 1 }).then(() => null)");
    page.until("document.querySelector('.run-line').textContent.includes('times real time')");
    assert_eq!(studio.interrupt(), Some(0));
    let runs = desk.names("runs");
    assert!(runs.len() == 2 && runs.iter().all(|name| !name.contains("partial")), "{runs:?}");
    page.until("!document.getElementById('lost').hidden");
}

#[test]
fn the_page_finds_the_program_again() {
    let desk = Desk::with(&[("servo.ron", SERVO)]);
    let studio = Studio::of(&desk, &[]);
    let Some(mut page) = shown(&studio) else { return };
    let port = studio.port().to_string();
    assert_eq!(studio.interrupt(), Some(0));
    page.until("!document.getElementById('lost').hidden");
    assert_eq!(
        page.value("document.querySelector('#project-view').innerText.includes('servo.ron')"),
        true,
        "what is here stays"
    );
    // Somebody else's server at the same port, with another token, does not get the page.
    let again = Studio::of(&desk, &["--port", &port]);
    page.open(&again.address);
    page.until("document.documentElement.dataset.ready === 'true' && document.getElementById('lost').hidden");
    let begin = Instant::now();
    fs::write(desk.0.join("servo.ron"), SERVO.replace("title: \"Servo\"", "title: \"Drive\""))
        .expect("a file");
    page.until("document.title === 'Drive – blocksim'");
    assert!(begin.elapsed() < Duration::from_secs(20));
}

/// A folder with the model of the robot and what it is made of.
fn with_robot() -> Desk {
    let desk = Desk::with(&[]);
    for folder in ["diagrams/irb2600", "params", "plugins"] {
        let to = desk.0.join(folder);
        fs::create_dir_all(to.parent().expect("a folder")).expect("a folder");
        let copied = Command::new("cp").arg("-r").arg(crate::support::root().join(folder)).arg(&to).status();
        assert!(copied.expect("cp").success());
    }
    desk
}

/// A folder with a small robot, one of whose axes slides.
fn with_scara() -> Desk {
    let desk = Desk::with(&[]);
    let from = crate::support::root().join("diagrams/scara");
    for name in ["scara.ron", "manipulator.ron", "cell.ron", "pick.ron"] {
        fs::copy(from.join(name), desk.0.join(name)).expect("a file");
    }
    desk
}

/// The motion planner of the small robot.
fn planner(studio: &Studio) -> Option<Page> {
    let mut page = shown(studio)?;
    page.value("location.hash = '#motion'");
    page.until("document.querySelectorAll('.joint').length === 4 && window.__m.frames > 0");
    Some(page)
}

#[test]
fn a_move_is_seen_in_3d() {
    // The project itself is trusted by the tests, as its plug-ins are built there.
    let home = crate::support::home();
    let mut command = crate::support::program();
    command
        .args(["studio", "--no-open", "--port", "0", "diagrams/irb2600/irb2600.ron"])
        .current_dir(crate::support::root());
    let studio = Studio::start(command.env("BLOCKSIM_HOME", home));
    let Some(mut page) = shown(&studio) else { return };
    page.value("location.hash = '#motion'");
    page.until("document.querySelectorAll('.axes tbody tr').length === 6");
    page.value("R.Motion.load('moves/demo_joint.ron')");
    page.until("R.Motion.found()?.passes && window.__m.frames > 0");
    // The tool where the axes lead it, at the start and at the end.
    let at = |page: &mut Page, t: f64| {
        page.value(&format!("R.setTime({t}); R.Space.paint(); document.querySelector('.pose').textContent"))
            .as_str()
            .expect("text")
            .to_owned()
    };
    let (start, end) = (at(&mut page, 0.0), at(&mut page, 9.0));
    assert!(start.contains("tcp") && end.contains("tcp") && start != end, "{start} and {end}");
}

#[test]
fn moves_are_planned_while_one_types_and_kept() {
    let desk = with_robot();
    let model = "diagrams/irb2600/irb2600.ron";
    let studio = Studio::of(&desk, &["--edit", model]);
    let Some(mut page) = shown(&studio) else { return };
    page.value("location.hash = '#motion'");
    page.until("document.querySelectorAll('.axes tbody tr').length === 6");
    // A picture shows what the fields of each kind mean.
    for (kind, words) in [
        ("linear", "The tool goes straight"),
        ("circular", "The tool goes along"),
        ("joint", "All axes begin"),
    ] {
        page.value(&format!("document.querySelector('input[name=kind][value={kind}]').click()"));
        page.until(&format!(
            "document.querySelector('.sketch figcaption').textContent.startsWith('{words}') && document.querySelector('.sketch .course').getBBox().width > 100"
        ));
    }
    // Nothing moves yet, which the planner refuses.
    page.until("document.querySelector('.move-result .bad')");
    let field = |name: &str| format!("document.querySelector('input[aria-label=\"{name}\"]')");
    for (name, value) in [
        ("A1 target", "60"),
        ("A2 target", "30"),
        ("A3 target", "-20"),
        ("A4 target", "45"),
        ("A5 target", "60"),
        ("A6 target", "90"),
    ] {
        page.value(&format!("{}.focus()", field(name)));
        page.replace(value);
    }
    page.until("R.Motion.found()?.passes");
    let by_command = desk.call(&[
        "plan",
        "joint",
        "--robot",
        model,
        "--from",
        "0,0,0,0,0,0",
        "--to",
        "60,30,-20,45,60,90",
        "--json",
    ]);
    page.until(&format!(
        "JSON.stringify(R.Motion.found().axes) === JSON.stringify(({}).axes)",
        by_command.out.trim()
    ));
    // Beyond the limit, with a decimal comma: told beside the field, and what was typed stays.
    page.value(&format!("{}.focus()", field("A3 target")));
    page.replace("90,5");
    page.until(
        "document.querySelectorAll('.axes .told')[2].textContent === 'target 90.50 is above the limit 75.00'",
    );
    page.until("document.querySelector('.move-result .bad') && R.Motion.found() === null");
    assert_eq!(page.value(&format!("{}.value", field("A3 target"))), "90,5");
    assert_eq!(page.value("document.querySelector('.keep button').disabled"), true);
    page.replace("abc");
    page.until("document.querySelectorAll('.axes .told')[2].textContent === 'target abc is not a number'");
    page.replace("-20,5");
    page.until("R.Motion.found()?.passes");
    // Kept as a file that the command reads, and used by the model; then taken back.
    page.value(&format!("{}.focus()", field("Name of the move")));
    page.replace("pick");
    page.value("document.querySelectorAll('.keep button')[1].click()");
    page.until("document.getElementById('status').textContent.includes('File(')");
    let kept = desk.read("diagrams/irb2600/moves/pick.ron");
    assert!(kept.contains("\"-20.5 deg\""), "{kept}");
    assert!(desk.read(model).contains("\"move\": File(\"moves/pick.ron\")"), "{}", desk.read(model));
    let checked = desk.call(&["plan", "sequence", "diagrams/irb2600/moves/pick.ron", "--robot", model]);
    assert_eq!(checked.code, Some(0), "{}", checked.err);
    page.value("document.activeElement.blur(); R.Values.undo()");
    page.until("document.getElementById('status').textContent.includes('before the last change')");
    assert!(desk.read(model).contains("moves/demo_joint.ron"));
    // A name that leads elsewhere, and a file that is there.
    for (name, told) in
        [("../escape", "the name of a move is a word"), ("pick", "there is a move `pick` already")]
    {
        page.value(&format!("{}.focus()", field("Name of the move")));
        page.replace(name);
        page.value("document.querySelector('.keep button').click()");
        page.until(&format!("document.getElementById('status').textContent.includes('{told}')"));
    }
    assert!(!desk.0.join("diagrams/irb2600/escape.ron").exists());
    // A line of the tool that was kept, and one out of reach.
    page.value("R.Motion.load('moves/demo_linear.ron')");
    page.until("R.Motion.typed().kind === 'linear' && R.Motion.found()?.passes");
    page.value(&format!("{}.focus()", field("target z")));
    page.replace("3000");
    page.until("document.querySelector('.move-result .bad')?.textContent.includes('does not reach')");
    assert_eq!(page.value("document.querySelector('.move-seen').classList.contains('old')"), true);
    // Its plug-ins have never been loaded here, so what the model looks like is not known.
    page.until("document.getElementById('space-view').textContent.includes('has been run once')");
    assert_eq!(page.complaints.len(), 2, "two refusals: {:?}", page.complaints);
}

#[test]
fn a_parameter_is_turned_while_a_run_goes_on_and_the_run_can_be_repeated() {
    let text = SERVO.replace("\"2 s\"", "\"60 s\", solver: Ode4(step: \"10 ms\")");
    let desk = Desk::with(&[("servo.ron", &text)]);
    let studio = Studio::of(&desk, &[]);
    let Some(mut page) = shown(&studio) else { return };
    page.value("location.hash = '#values'");
    page.until("document.querySelector('input[aria-label=\"demand.after\"]')");
    page.value("[...document.querySelector('input[aria-label=\"demand.after\"]').closest('td').querySelectorAll('button')].find((b) => b.textContent === 'Turn').click()");
    page.until("document.querySelector('.knob input[type=range]')");
    page.value("R.Desk.ask('run', { speed: 1 }).then(() => null)");
    page.until("R.Live.rows() > 60");
    page.key(" ");
    page.until("document.querySelector('.run-line').textContent.includes('paused')");
    page.value("(() => { const slider = document.querySelector('.knob input[type=range]'); slider.value = 45; slider.dispatchEvent(new Event('input')); })()");
    page.until("/^since [0-9.]+ s$/.test(document.querySelector('.knob .note').textContent)");
    // A unit of something else is refused, and the run goes on.
    page.value("document.querySelector('.knob input[type=text]').focus()");
    page.replace("3 kg");
    page.key("Enter");
    page.until("document.querySelector('.knob .note.bad')");
    page.value("document.activeElement.blur(); R.Desk.ask('control', { do: 'speed', speed: 0 }).then(() => R.Desk.ask('control', { do: 'go' })).then(() => null)");
    page.until("document.querySelector('.run-line').textContent.includes('60 s simulated')");
    page.until(
        "[...document.querySelectorAll('#plots .entry b')].map((b) => b.textContent).join() === '45,45'",
    );
    let run = format!("runs/{}", desk.names("runs")[0]);
    let events = desk.read(&format!("{run}/events.csv"));
    let line = events.lines().find(|line| line.contains("is set to")).expect("an event");
    let at = line.split(',').next().expect("a time");
    assert!(line.contains("demand.after") && line.contains("is set to 45 deg"), "{line}");
    // The same by a command, to the bit.
    let change = format!("{at}:demand.after=45 deg");
    let again = desk.call(&["run", "servo.ron", "--change", &change, "--out", "again", "--quiet"]);
    assert_eq!(again.code, Some(0), "{}", again.err);
    assert_eq!(desk.read(&format!("{run}/signals.csv")), desk.read("again/signals.csv"));
    assert_eq!(desk.read("servo.ron"), text);
}

#[test]
fn what_is_turned_stands_where_the_run_stands_and_stays_with_its_model() {
    let text = SERVO.replace("\"2 s\"", "\"400 s\"");
    let desk = Desk::with(&[("servo.ron", &text), ("other.ron", &SERVO.replace("gain", "amplifier"))]);
    let studio = Studio::of(&desk, &[]);
    let Some(mut page) = shown(&studio) else { return };
    let choose = |page: &mut Page, model: &str| {
        page.value(&format!("(() => {{ const choice = document.getElementById('models'); choice.value = '{model}'; choice.dispatchEvent(new Event('change')); }})()"));
        page.until(&format!("R.Project.known().model === '{model}'"));
    };
    choose(&mut page, "servo.ron");
    page.value("location.hash = '#values'");
    page.until("document.querySelector('#values-view input[aria-label=\"gain.k\"]')");
    page.value("[...document.querySelector('#values-view input[aria-label=\"gain.k\"]').closest('tr').querySelectorAll('button')].find((b) => b.textContent === 'Turn').click()");
    let set = |page: &mut Page, value: &str| {
        page.value("document.querySelector('.knob input[type=text]').focus()");
        page.replace(value);
        page.key("Enter");
    };
    // With 8 from the start, 3 later on.
    set(&mut page, "8 1/s");
    page.until("document.querySelector('.knob .note').textContent === 'for the next run'");
    assert_eq!(page.value("Math.round(document.querySelector('.knob input[type=range]').value)"), 8);
    page.value("(() => { const speed = document.querySelector('select[aria-label=Speed]'); speed.value = '10'; speed.dispatchEvent(new Event('change')); })()");
    page.value("R.Live.start()");
    page.until("R.Live.rows() > 5");
    page.value("R.Desk.ask('control', { do: 'pause' }).then(() => null)");
    page.until("document.querySelector('.run-line').textContent.includes('paused')");
    set(&mut page, "3 1/s");
    page.until("/^since [0-9.]+ s$/.test(document.querySelector('.knob .note').textContent)");
    page.value("R.Desk.ask('control', { do: 'back', t: 0.1 }).then(() => null)");
    page.until("document.querySelector('.knob .note').textContent === ''");
    let stands = page.value(
        "document.querySelector('.knob input').value + ', ' + Math.round(document.querySelector('.knob input[type=range]').value)",
    );
    assert_eq!(stands, "8 1/s, 8");
    page.value("R.Desk.ask('control', { do: 'stop' }).then(() => null)");
    // What is left of it may be so short that it comes to its end.
    page.until("/ended at|simulated/.test(document.querySelector('.run-line').textContent)");
    // Another model has no such parameter.
    choose(&mut page, "other.ron");
    page.until("document.querySelectorAll('.knob').length === 0");
    page.value("R.Live.start()");
    page.until("document.querySelector('.run-line').textContent.includes('other.ron: 2 s simulated')");
    choose(&mut page, "servo.ron");
    page.until("document.querySelector('.knob input')?.value === '8 1/s'");
    assert_eq!(page.complaints, Vec::<String>::new());
}
