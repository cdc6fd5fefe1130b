//! The panel of a model, the past of a run and its other futures, and signals that are recorded because somebody asks for them.

use super::browser::Page;
use super::{Studio, shown};
use crate::desk::Desk;

const DRIVE: &str = r#"// A drive with a panel.
Diagram(
    title: "Drive",
    simulation: (stop_time: "400 s", solver: Ode45(rtol: 1e-6, max_step: "20 ms")),
    panel: [
        Slider("gain.k", "0 .. 20"),
        Knob(target: "demand.value", range: "-180 .. 180 deg", label: "Demand"),
        Switch(target: "load.value", off: "0 rad/s", on: "1 rad/s", label: "Load"),
        Button(target: "stop.value", label: "Stop"),
        Gauge(signal: "angle.y", range: "-90 .. 90 deg", label: "Angle"),
        Gauge("gain.y"),
        Lamp(signal: "latch.q", label: "Stopped"),
    ],
    blocks: {
        "demand": Constant(value: "90 deg"),
        "error": Sum(signs: "+-"),
        "gain": Gain(k: "6 1/s"),
        "load": Constant(value: "0 rad/s"),
        "speed": Sum(signs: "+-"),
        "angle": Integrator(),
        "stop": Constant(value: false),
        "never": Constant(value: false),
        "latch": SrFlipFlop(priority: Set),
        "scope": Scope(inputs: ["set", "actual"], display: "deg"),
    },
    connections: [
        "demand.y -> error.u1, scope.set", "angle.y -> error.u2, scope.actual", "error.y -> gain.u", "gain.y -> speed.u1",
        "load.y -> speed.u2", "speed.y -> angle.u", "stop.y -> latch.set", "never.y -> latch.reset",
    ],
)
"#;

/// The events of a run that set something.
fn set_in(desk: &Desk, run: &str) -> Vec<String> {
    let events = desk.read(&format!("{run}/events.csv"));
    events.lines().filter(|line| line.contains("is set to")).map(str::to_owned).collect()
}

/// That a run is what the command that the page shows makes, to the bit.
fn is_repeated(desk: &Desk, page: &mut Page, run: &str, out: &str) {
    let line = page.value("document.querySelector('.command code').textContent");
    let line = line.as_str().expect("a command");
    let words = words(line);
    assert_eq!(words[..2], ["blocksim", "run"], "{line}");
    let mut words: Vec<&str> = words[1..].iter().map(String::as_str).collect();
    words.extend(["--out", out, "--quiet"]);
    let again = desk.call(&words);
    assert_eq!(again.code, Some(0), "{line}: {}", again.err);
    for file in ["signals.csv", "events.csv"] {
        let [here, there] = [run, out].map(|folder| desk.read(&format!("{folder}/{file}")));
        assert!(here == there, "{line}: {file} differs: {} and {} bytes", here.len(), there.len());
    }
}

/// The words of a line of a shell, where quotes hold blanks together.
fn words(line: &str) -> Vec<String> {
    let (mut all, mut word, mut quoted) = (Vec::new(), String::new(), false);
    for sign in line.chars() {
        match sign {
            '"' => quoted = !quoted,
            ' ' if !quoted => all.push(std::mem::take(&mut word)),
            sign => word.push(sign),
        }
    }
    all.push(word);
    all
}

#[test]
fn a_panel_changes_a_run_and_shows_it() {
    let desk = Desk::with(&[("drive.ron", DRIVE)]);
    let studio = Studio::of(&desk, &[]);
    let Some(mut page) = shown(&studio) else { return };
    page.value("location.hash = '#run'");
    page.until("document.querySelectorAll('#panel .element').length === 7");
    // Everything has its role, its name and its value.
    let roles = "[...document.querySelectorAll('#panel [role=slider], #panel input[type=range], #panel [role=switch], #panel .push, #panel \
                 [role=meter], #panel .lamp')].map((e) => `${e.getAttribute('role') ?? e.type}|${e.getAttribute('aria-label') ?? \
                 e.textContent}`).join(', ')";
    assert_eq!(
        page.value(roles),
        "range|gain.k, slider|Demand, switch|Load, button|Stop, meter|Angle, meter|gain.y, img|Stopped: not known"
    );
    // At real time, as somebody is to see what the panel does.
    page.key("F5");
    page.until("R.Live.rows() > 20");
    page.until("document.querySelector('[role=meter]').getAttribute('aria-valuetext')?.endsWith('°')");
    page.until("document.querySelector('.lamp').getAttribute('aria-label') === 'Stopped: off'");
    // Without a mouse: a slider, a knob, a switch, and a button that is held.
    page.value("document.querySelector('.slider input[type=range]').focus()");
    page.press("End", "");
    page.until("/^since/.test(document.querySelector('.slider .note').textContent)");
    assert_eq!(page.value("document.querySelector('.slider .amount input').value"), "20");
    page.value("document.querySelector('.dial').focus()");
    page.press("Home", "");
    page.until("/^since/.test(document.querySelector('.knob-element .note').textContent)");
    assert_eq!(page.value("document.querySelector('.dial').getAttribute('aria-valuetext')"), "−180 °");
    page.value("document.querySelector('.switch').focus()");
    page.key(" ");
    page.until("document.querySelector('.switch').getAttribute('aria-checked') === 'true'");
    page.value("document.querySelector('.push').focus()");
    page.key(" ");
    page.until("document.querySelector('.lamp').getAttribute('aria-label') === 'Stopped: on'");
    page.until("document.querySelector('.push').getAttribute('aria-pressed') === 'false'");
    // A number that is typed, wrong ones first.
    page.value("document.querySelector('.slider .amount input').focus()");
    for (typed, told) in
        [("abc", "abc is not a number in 1/s"), ("21", "21 1/s is not within the range from 0 to 20 1/s")]
    {
        page.replace(typed);
        page.key("Enter");
        page.until(&format!("document.querySelector('.slider .note.bad')?.textContent === '{told}'"));
        assert_eq!(page.value("document.querySelector('.slider .amount input').value"), typed);
    }
    page.replace("2,5 1/s");
    page.key("Enter");
    page.until("/^since/.test(document.querySelector('.slider .note').textContent)");
    page.value("document.activeElement.blur()");
    page.until("document.querySelector('.command code').textContent.includes('gain.k=2.5 1/s')");
    page.value("R.Desk.ask('control', { do: 'speed', speed: 0 }).then(() => null)");
    page.until("document.querySelector('.run-line').textContent.includes('400 s simulated')");
    // What the gauge shows is what was recorded last.
    let shown = page.value("[...document.querySelectorAll('.gauge b')].map((b) => b.textContent).join()");
    let run = format!("runs/{}", desk.names("runs")[0]);
    assert_eq!(shown, "−202.9,1", "180 deg and 1 rad/s over 2.5 1/s");
    let set = set_in(&desk, &run);
    assert_eq!(set.len(), 6, "{set:?}");
    assert!(set.iter().any(|event| event.contains("stop.value,is set to true")), "{set:?}");
    is_repeated(&desk, &mut page, &run, "again");
    assert_eq!(desk.read("drive.ron"), DRIVE);
    assert_eq!(page.complaints, Vec::<String>::new());
}

#[test]
fn a_run_begins_with_what_its_panel_shows() {
    let desk = Desk::with(&[("drive.ron", &DRIVE.replace("400 s", "2 s"))]);
    let studio = Studio::of(&desk, &[]);
    let Some(mut page) = shown(&studio) else { return };
    page.value("location.hash = '#run'");
    page.until("document.querySelectorAll('#panel .element').length === 7");
    page.value("R.Panel.elements()[1].set(45, true)");
    page.until("document.querySelector('.knob-element .note').textContent === 'for the next run'");
    page.value("R.Desk.ask('run', { speed: 0, set: R.Panel.settings() }).then(() => null)");
    page.until("document.querySelector('.run-line').textContent.includes('2 s simulated')");
    page.until(
        "[...document.querySelectorAll('#plots .entry b')].map((b) => b.textContent).join() === '45,45'",
    );
    let run = format!("runs/{}", desk.names("runs")[0]);
    is_repeated(&desk, &mut page, &run, "again");
    // The file has changed: what it has now is shown, and what was turned stays where it says the same.
    std::fs::write(desk.0.join("drive.ron"), DRIVE.replace("0 .. 20", "0 .. 9")).expect("a file");
    page.until("document.querySelector('.slider input[type=range]').max === '9'");
    assert_eq!(page.value("document.querySelector('.knob-element .amount input').value"), "45");
    page.value(
        "[...document.querySelectorAll('#panel button')].find((b) => b.textContent === 'As written').click()",
    );
    page.until("document.querySelector('.knob-element .amount input').value === '90'");
}

#[test]
fn a_run_goes_back_and_has_another_future() {
    let desk = Desk::with(&[("drive.ron", DRIVE)]);
    let studio = Studio::of(&desk, &[]);
    let Some(mut page) = shown(&studio) else { return };
    page.value("location.hash = '#run'");
    page.value("R.Desk.ask('run', { speed: 1 }).then(() => null)");
    page.until("R.Live.rows() > 40");
    page.value("R.Panel.elements()[1].set(-45, true)");
    page.until("document.querySelector('.command code').textContent.includes('demand.value=-45 deg')");
    page.key(" ");
    page.until("document.querySelector('.run-line').textContent.includes('paused')");
    let turned =
        page.value("document.querySelector('.command code').textContent.match(/after ([0-9.]+)s/)[1]");
    let turned: f64 = turned.as_str().expect("a time").parse().expect("a time");
    // Before the change, by the slider and a key.
    let before = turned / 2.0;
    page.value(&format!("(() => {{ const slider = document.querySelector('.instant input'); slider.value = {before}; slider.dispatchEvent(new Event('input')); }})()"));
    page.key("b");
    page.until("document.querySelector('.futures a')");
    page.until(
        "R.Futures.left().length === 1 && document.querySelector('.run-line').textContent.includes('paused')",
    );
    let runs = desk.names("runs");
    let first =
        runs.iter().find(|name| !name.ends_with(".partial")).expect("the future that was left").clone();
    assert_eq!(set_in(&desk, &format!("runs/{first}")).len(), 1, "it is kept as it was");
    // The panel stands where the run does.
    assert_eq!(page.value("document.querySelector('.knob-element .amount input').value"), "90");
    assert!(
        page.value("document.querySelector('.command code').textContent")
            .as_str()
            .is_some_and(|line| !line.contains("--change"))
    );
    // Another future, to its end.
    page.value("R.Panel.elements()[0].set(3, true)");
    page.until("document.querySelector('.command code').textContent.includes('gain.k=3 1/s')");
    page.value("R.Desk.ask('control', { do: 'speed', speed: 0 }).then(() => R.Desk.ask('control', { do: 'go' })).then(() => null)");
    page.until("document.querySelector('.run-line').textContent.includes('400 s simulated')");
    let second = desk.names("runs").into_iter().find(|name| *name != first).expect("the other future");
    is_repeated(&desk, &mut page, &format!("runs/{second}"), "again");
    // Both have one past, to the bit.
    let rows = |name: &str| desk.read(&format!("runs/{name}/signals.csv"));
    let (one, other) = (rows(&first), rows(&second));
    let past = |text: &str| -> Vec<String> {
        let time = |line: &str| line.split(',').next().and_then(|t| t.parse::<f64>().ok());
        text.lines().filter(|line| time(line).is_some_and(|t| t < before)).map(str::to_owned).collect()
    };
    assert!(past(&one).len() > 20 && past(&one) == past(&other));
    assert_ne!(one.lines().last(), other.lines().last());
    // Behind its end it goes back as well, and both are compared on a page.
    page.value("(() => { const slider = document.querySelector('.instant input'); slider.value = 1; slider.dispatchEvent(new Event('input')); })()");
    page.value("document.querySelector('.instant button').click()");
    page.until(
        "R.Futures.left().length === 2 && document.querySelector('.run-line').textContent.includes('paused')",
    );
    page.value("R.Desk.ask('control', { do: 'go' }).then(() => null)");
    page.until("document.querySelector('.run-line').textContent.includes('400 s simulated')");
    page.until("[...document.querySelectorAll('.futures a')].filter((a) => a.textContent === 'Compare with it').length === 2");
    let link = page.value("document.querySelectorAll('.futures a')[1].getAttribute('href').slice(6)");
    let answer = studio.asked("GET", &format!("/runs/{}", link.as_str().expect("a link")), &[], "");
    assert!(answer.starts_with("HTTP/1.1 200") && answer.contains("id=\"compared\""), "{}", &answer[..200]);
    // A time that has not come yet.
    page.value("R.Desk.ask('control', { do: 'back', t: 500 }).then(() => null)");
    page.until(
        "document.getElementById('status').textContent.includes('can go back to a time from 0 to 400 s')",
    );
    assert_eq!(page.complaints, Vec::<String>::new());
    assert_eq!(studio.interrupt(), Some(0));
    assert!(desk.names("runs").iter().all(|name| !name.contains("partial")));
}

#[test]
fn a_wire_is_put_into_a_scope_before_and_while_a_run_goes_on() {
    let desk = Desk::with(&[("drive.ron", DRIVE)]);
    let studio = Studio::of(&desk, &[]);
    let Some(mut page) = shown(&studio) else { return };
    page.value("location.hash = '#diagram'");
    page.until("document.querySelectorAll('#diagram-view [data-node]').length === 10");
    // Before: by the keyboard.
    let wire = "[...document.querySelectorAll('#diagram-view [data-net]')].find((g) => g.getAttribute('aria-label').startsWith('signal error.y'))";
    page.value(&format!("{wire}.dispatchEvent(new MouseEvent('click', {{ bubbles: true }}))"));
    page.until("document.querySelector('.inspector button')?.textContent === '+ scope'");
    page.value(&format!("{wire}.focus()"));
    page.key("Enter");
    page.until("document.querySelector('.extra')?.textContent.includes('error.y')");
    page.value("R.Desk.ask('run', { speed: 1, record: ['error.y'] }).then(() => null)");
    page.until("R.Live.rows() > 30");
    page.value("R.Panel.elements()[0].set(3, true)");
    page.until("document.querySelector('.command code').textContent.includes('gain.k=3 1/s')");
    let shown = "[...document.querySelectorAll('#plots .entry')].map((e) => e.title).join()";
    assert_eq!(page.value(shown), "scope.actual,scope.set,error.y");
    // While it runs: it is soon where it was, with all that was set.
    page.value("R.record('speed.y')");
    page.until(&format!("{shown} === 'scope.actual,scope.set,error.y,speed.y'"));
    page.until("document.querySelector('.command code').textContent.includes('gain.k=3 1/s')");
    page.value("R.Desk.ask('control', { do: 'speed', speed: 0 }).then(() => null)");
    page.until("document.querySelector('.run-line').textContent.includes('400 s simulated')");
    let runs = desk.names("runs");
    assert_eq!(runs.len(), 1, "what was repeated is not kept: {runs:?}");
    is_repeated(&desk, &mut page, &format!("runs/{}", runs[0]), "again");
    let head = desk.read(&format!("runs/{}/signals.csv", runs[0]));
    assert!(head.lines().next().is_some_and(|line| line.contains("error.y") && line.contains("speed.y")));
    // Values of both stand on the wires.
    page.value("location.hash = '#diagram'");
    page.until("[...document.querySelectorAll('#diagram-view .value')].length >= 4");
    assert_eq!(desk.read("drive.ron"), DRIVE);
    assert_eq!(page.complaints, Vec::<String>::new());
}

#[test]
fn layers_are_laid_over_the_drawing() {
    let sampled = DRIVE
        .replace("Gain(k: \"6 1/s\")", "DiscretePid(kp: \"6 1/s\", ts: \"20 ms\")")
        .replace("gain.k", "gain.kp");
    let sampled = sampled.replace("error.y -> gain.u", "error.y -> gain.e").replace("gain.y", "gain.u");
    let desk = Desk::with(&[("drive.ron", &sampled)]);
    let studio = Studio::of(&desk, &[]);
    let Some(mut page) = shown(&studio) else { return };
    page.value("location.hash = '#diagram'");
    page.until("document.querySelectorAll('#diagram-view [data-node]').length === 10");
    let switch = |page: &mut Page, name: &str| {
        page.value(&format!("[...document.querySelectorAll('.diagram-bar label')].find((l) => l.textContent.trim() === '{name}').click()"));
    };
    for (name, layer) in [
        ("units", "units"),
        ("sample times", "rates"),
        ("order", "order"),
        ("feedback", "feedback"),
        ("algebraic loops", "loops"),
    ] {
        switch(&mut page, name);
        page.until(&format!("document.querySelector('#diagram-view .layer-{layer}')"));
    }
    page.until("document.querySelector('.layer-units').textContent.includes('rad/s')");
    page.until("document.querySelector('.layer-feedback path.back')");
    page.until("document.querySelector('.legend').textContent.includes('20 ms') && document.querySelector('.legend').textContent.includes('no algebraic loop here')");
    switch(&mut page, "order");
    page.until("!document.querySelector('.layer-order')");
    // The same in words beside the drawing.
    page.value("R.Diagram.show('', 'gain')");
    page.until("document.querySelector('.inspector').innerText.includes('20 ms')");
    assert_eq!(page.complaints, Vec::<String>::new());
}
