//! What is told of a planned move, and the file that is written.

use blocksim_numbers::format::significant;
use blocksim_robotics::motion::AxisKind;
use blocksim_robotics::planner::{
    AxisExtremes, Chosen, Course, Finding, Findings, Review, Severity, Tried, configuration_word,
};
use blocksim_robotics::robot::Robot;
use serde_json::{Value, json};

use crate::terminal::format::short_time;

/// For people: duration, margins of each axis, the tool, and what is exceeded.
pub fn text(robot: &Robot, course: &dyn Course, review: &Review) -> String {
    let findings = &review.findings;
    let mut text =
        format!("move       {} s, {} waypoints checked\n", short_time(course.duration()), findings.waypoints);
    let slides = findings.axes.iter().any(|axis| axis.limits.kind == AxisKind::Sliding);
    text += match slides {
        false => "axis   low [deg] high [deg]  to limits [deg]   speed  acceleration\n",
        true => "axis         low       high        to limits   speed  acceleration\n",
    };
    for (i, axis) in findings.axes.iter().enumerate() {
        let margin = (axis.lowest - axis.limits.lower).min(axis.limits.upper - axis.highest);
        let kind = axis.limits.kind;
        let unit = if slides { format!(" {}", kind.unit()) } else { String::new() };
        let shown = |value| format!("{}{unit}", fixed(kind.shown(value)));
        text += &format!(
            "{:>4}  {:>10}  {:>9}  {:>15}  {:>4} %  {:>10} %\n",
            i + 1,
            shown(axis.lowest),
            shown(axis.highest),
            shown(margin),
            share(axis.speed, axis.limits.speed),
            share(axis.acceleration, axis.limits.acceleration),
        );
    }
    text += &tool(robot, findings);
    text += &motors(findings);
    if let Some(narrow) = findings.narrowest {
        text += &format!(
            "singular   nearest at t = {} s: smallest singular value {}\n",
            short_time(narrow.t),
            significant(narrow.margin, 3)
        );
    }
    // Collisions have lines of their own.
    for Finding { severity, message, source, help, .. } in review.all.iter().filter(|f| f.code != "collision")
    {
        let what = match severity {
            Severity::Violation => "exceeded  ",
            Severity::Note => "note      ",
        };
        let source = source.as_ref().map(|source| format!(" ({source})")).unwrap_or_default();
        text += &format!("{what} {message}{source}\n  = help: {help}\n");
    }
    text
}

/// What the tool does at most.
fn tool(robot: &Robot, findings: &Findings) -> String {
    let limits = robot.tcp_limits();
    let of = |value: f64, limit: f64| match limit.is_finite() {
        true => format!(", {} % of its limit", share(value, limit)),
        false => String::new(),
    };
    format!(
        "tool       at most {} mm/s{}; {} m/s^2{}; turns with {:.1} deg/s\n",
        significant(1e3 * findings.tool_speed, 4),
        of(findings.tool_speed, limits.speed),
        significant(findings.tool_acceleration, 3),
        of(findings.tool_acceleration, limits.acceleration),
        findings.tool_turning.to_degrees(),
    )
}

/// What the motors have to give, where their limits are known.
fn motors(findings: &Findings) -> String {
    let one = |(i, axis): (usize, &AxisExtremes)| {
        let effort = axis.torque?;
        Some(format!(
            "axis {} {} % (t = {} s)",
            i + 1,
            share(effort.largest, effort.limit),
            significant(effort.t, 3)
        ))
    };
    let all: Vec<String> = findings.axes.iter().enumerate().filter_map(one).collect();
    match all.is_empty() {
        true => String::new(),
        false => format!("motors     {}\n", all.join(", ")),
    }
}

/// For people: how the start was chosen.
pub fn chosen(chosen: Option<&Chosen>) -> String {
    let Some(Chosen { configuration: Some(configuration), passes, tried, .. }) = chosen else {
        return String::new();
    };
    let mut text = format!("starts     in the configuration {}", configuration_word(*configuration));
    text += match (passes, tried.is_empty()) {
        (true, true) => "\n",
        (true, false) => ", the nearest that can go the whole way\n",
        (false, _) => ", though none can go the whole way\n",
    };
    for tried in tried {
        text += &format!("           not {}: {}\n", configuration_word(tried.configuration), tried.reason);
    }
    text
}

/// For programs: the same.
pub fn choice(chosen: Option<&Chosen>) -> Value {
    let Some(chosen) = chosen else { return Value::Null };
    let not =
        |tried: &Tried| json!({ "word": configuration_word(tried.configuration), "reason": tried.reason });
    json!({
        "word": chosen.configuration.map(configuration_word), "start": chosen.q, "passes": chosen.passes,
        "not": chosen.tried.iter().map(not).collect::<Vec<_>>(),
    })
}

fn fixed(value: f64) -> String {
    format!("{:.2}", if value.abs() < 5e-3 { 0.0 } else { value })
}

fn share(value: f64, limit: f64) -> String {
    format!("{:.0}", 100.0 * value / limit)
}

/// For programs; SI units.
pub fn data(robot: &Robot, course: &dyn Course, review: &Review) -> Value {
    let findings = &review.findings;
    let axes: Vec<Value> = findings
        .axes
        .iter()
        .map(|axis| {
            json!({
                "lowest": axis.lowest, "highest": axis.highest, "speed": axis.speed, "acceleration": axis.acceleration,
                "margins": {
                    "lower": axis.lowest - axis.limits.lower, "upper": axis.limits.upper - axis.highest,
                    "speed": axis.limits.speed - axis.speed, "acceleration": axis.limits.acceleration - axis.acceleration,
                },
                "torque": axis.torque.map(|effort| {
                    json!({ "largest": effort.largest, "limit": effort.limit, "time": effort.t })
                }),
            })
        })
        .collect();
    let narrowest = findings.narrowest.map(|narrow| json!({ "margin": narrow.margin, "time": narrow.t }));
    let limits = robot.tcp_limits();
    let of = |severity| -> Vec<Value> {
        let all = review.all.iter().filter(|finding| finding.severity == severity);
        all.filter(|finding| finding.code != "collision").map(finding).collect()
    };
    json!({
        "v": 1, "type": "plan", "duration": course.duration(), "waypoints": findings.waypoints, "axes": axes,
        "tool_speed": findings.tool_speed, "tool_acceleration": findings.tool_acceleration,
        "tool_turning": findings.tool_turning,
        // without a limit it is null
        "tool_limits": { "speed": limits.speed, "acceleration": limits.acceleration },
        "narrowest": narrowest, "violations": of(Severity::Violation), "notes": of(Severity::Note),
        "passes": review.passes(),
    })
}

/// A finding for programs.
fn finding(finding: &Finding) -> Value {
    json!({
        "code": finding.code, "what": finding.message, "axis": finding.axis.map(|axis| axis + 1),
        "time": finding.spot.t, "share": finding.spot.share, "way": finding.spot.way.map(|way| way.done),
        "move": finding.spot.step.map(|step| step + 1), "value": finding.value, "worst": finding.worst, "limit": finding.limit,
        "source": finding.source, "help": finding.help,
    })
}

/// The move as a file: what was asked as it was typed, and what came out, which is not read again.
pub fn file(asked: &str, course: &dyn Course, findings: &Findings) -> String {
    let end = asked.trim_end().strip_suffix(')').unwrap_or(asked.trim_end()).trim_end();
    let comma = if end.ends_with([',', '(']) { "" } else { "," };
    let result = format!(
        "    result: (planner: Text(\"blocksim {}\"), duration: \"{} s\", waypoints: {}, tool_speed: \"{} mm/s\"),\n",
        env!("CARGO_PKG_VERSION"),
        short_time(course.duration()),
        findings.waypoints,
        significant(1e3 * findings.tool_speed, 4),
    );
    // Planned once more, a file keeps one result.
    match asked.contains("result:") {
        true => asked.to_owned(),
        false => format!("{end}{comma}\n{result})\n"),
    }
}
