//! Nyquist plots, poles and zeros, and root loci of `blocksim linearise`.

use crate::linearise::{Desk, near, number, said};

fn drawing(desk: &Desk, words: &[&str]) -> String {
    let file = desk.0.join("drawing.svg");
    let output = desk.linearise(&[words, &["--svg", "drawing.svg", "--yes", "--no-plot"]].concat());
    assert_eq!(output.status.code(), Some(0), "{words:?}: {}", said(&output));
    std::fs::read_to_string(file).expect("a drawing")
}

#[test]
fn each_chart_shows_what_it_is_for() {
    let desk = Desk::new("charts");
    let open = ["lags.ron", "--open", "gain.y"];
    let with = |chart: &'static str| [&open[..], &["--chart", chart]].concat();
    let nyquist = drawing(&desk, &with("nyquist"));
    for text in [
        "critical point",
        "closest approach",
        "frequencies above zero",
        "frequencies below zero",
        "stable when closed",
    ] {
        assert!(nyquist.contains(text), "{text}");
    }
    let poles = drawing(&desk, &with("poles"));
    assert!(poles.contains("poles of the closed loop") && poles.contains("real part [rad/s]"));
    // Of three equal lags: three marks each, and one in the legend.
    assert_eq!(poles.matches("l8.4 8.4").count(), 4);
    assert!(drawing(&desk, &open).contains("frequency [rad/s]"));
    assert!(drawing(&desk, &["lags.ron"]).contains("Lags: poles"));
    let sampled =
        drawing(&desk, &["lags.ron", "--sampled", "--from", "c.y", "--to", "slow.y", "--chart", "poles"]);
    assert!(sampled.contains("real part of z"));
    let dark = drawing(&desk, &[&with("nyquist")[..], &["--theme", "dark"]].concat());
    assert!(dark.contains("#0F172A") && !dark.contains("#FFFFFF"));
    let output = desk.linearise(&[&with("nyquist")[..], &["--png", "n.png", "--no-plot"]].concat());
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    assert!(std::fs::read(desk.0.join("n.png")).unwrap().starts_with(b"\x89PNG"));
}

#[test]
fn the_locus_of_a_gain_crosses_the_border_at_the_gain_margin() {
    let desk = Desk::new("locus");
    let found = desk.json(&["lags.ron", "--open", "gain.y", "--locus"]);
    let locus = &found["locus"];
    near(&locus["borders"][0], 4.0);
    assert_eq!(locus["borders"].as_array().map(Vec::len), Some(1));
    for point in locus["points"].as_array().unwrap() {
        // (s + 1)^3 = -2 K: the real pole is at -1 - cbrt(2 K).
        let root = (2.0 * number(&point["value"])).cbrt();
        let poles = point["poles"].as_array().unwrap();
        let near =
            poles.iter().map(|p| (number(&p[0]) + 1.0 + root).hypot(number(&p[1]))).fold(9.0, f64::min);
        assert!(near < 2e-5, "{point}");
    }
    let picture = drawing(&desk, &["lags.ron", "--open", "gain.y", "--locus"]);
    assert!(
        picture.contains("Poles over the gain of the loop through gain.y")
            && picture.contains("closed with its own gain")
    );
    let text = desk.linearise(&["lags.ron", "--open", "gain.y", "--locus", "--no-plot"]);
    let text = String::from_utf8_lossy(&text.stdout).into_owned();
    assert!(text.ends_with("stable at first, which changes at 4.0000\n"), "{text}");
}

#[test]
fn the_locus_of_a_parameter_has_the_poles_of_each_value() {
    let desk = Desk::new("parameter");
    let found = desk.json(&["lags.ron", "--locus=gain=1,7,9", "--open", "gain.y"]);
    let points = found["locus"]["points"].as_array().unwrap();
    assert_eq!(
        points.iter().map(|p| p["stable"].as_bool().unwrap()).collect::<Vec<_>>(),
        [true, true, false]
    );
    for point in points {
        let root = number(&point["value"]).cbrt();
        let poles = point["poles"].as_array().unwrap();
        let has = |re: f64| poles.iter().any(|p| (number(&p[0]) - re).abs() < 1e-6);
        assert!(poles.len() == 3 && has(-1.0 - root) && has(root / 2.0 - 1.0), "{point}");
    }
    // Without signals all poles of the model.
    let all = desk.json(&["lags.ron", "--locus=gain=1..3/3"]);
    assert_eq!(all["locus"]["points"][2]["poles"].as_array().map(Vec::len), Some(4));
    let picture = drawing(&desk, &["lags.ron", "--locus=gain=1..9/9"]);
    assert!(picture.contains("Poles over the parameter gain") && picture.contains(">at 9"));
    let text = desk.linearise(&["lags.ron", "--locus=gain=7,9"]);
    let text = String::from_utf8_lossy(&text.stdout).into_owned();
    assert!(text.ends_with("stable at first, which changes at 7.000 to 9.000\n"), "{text}");
}

#[test]
fn charts_that_make_no_sense_are_refused_with_a_remedy() {
    let desk = Desk::new("refusals");
    let late = r#"Diagram(simulation: (stop_time: "1 s"), blocks: { "late": TransportDelay(delay: "0.1 s"), "back": Gain(k: -1),
        "x": Integrator(x0: 1), "scope": Scope }, connections: ["x.y -> late.u, scope.u", "late.y -> back.u", "back.y -> x.u"])"#;
    std::fs::write(desk.0.join("late.ron"), late).unwrap();
    for (words, code, expected) in [
        (
            &["lags.ron", "--open", "gain.y", "--chart", "nyquist"][..],
            2,
            "name one with --svg FILE or --png FILE",
        ),
        (
            &["lags.ron", "--open", "gain.y", "--chart", "locus", "--svg", "a.svg"],
            2,
            "add --locus for the gain of a loop",
        ),
        (&["lags.ron", "--chart", "bode", "--svg", "a.svg"], 2, "there is no response without a signal"),
        (&["lags.ron", "--chart", "nyquist", "--svg", "a.svg"], 2, "there is no response without a signal"),
        (&["lags.ron", "--locus"], 2, "there is no loop whose gain varies"),
        (
            &["lags.ron", "--from", "gain.y", "--to", "c.y", "--locus"],
            2,
            "cut one with --open and without --from",
        ),
        (&["lags.ron", "--locus=gain=1..3"], 2, "how many values of `gain`?"),
        (&["lags.ron", "--locus=gian=1,2"], 3, "gian"),
        (&["late.ron", "--open", "back.y", "--locus"], 2, "draw the response instead, --chart nyquist"),
        (&["late.ron", "--locus=back.k=-1,-2"], 2, "a dead time makes infinitely many poles"),
        (
            &["late.ron", "--from", "back.y", "--to", "x.y", "--chart", "poles", "--svg", "a.svg"],
            2,
            "there are infinitely many poles",
        ),
    ] {
        let output = desk.linearise(words);
        assert_eq!(output.status.code(), Some(code), "{words:?}: {}", said(&output));
        assert!(said(&output).contains(expected), "{words:?}: {}", said(&output));
        assert!(!desk.0.join("a.svg").exists(), "{words:?}");
    }
}
