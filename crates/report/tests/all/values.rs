//! Values in the page: on wires, in the table, as text and as a file; and the way to them.

use crate::browser::{answered, with_script};
use blocksim_report::{
    Diagram, Drawing, Inspected, Level, Net, Panel, Probe, Report, Role, Rows, Series, Unseen, html,
};

fn series(name: &str, values: Vec<f64>) -> Series {
    Series {
        name: name.to_owned(),
        path: format!("scope.{name}"),
        role: Role::Plain,
        held: false,
        values,
        other: None,
    }
}

/// A ramp from 0 to 4 V in 2 s that jumps to 10 V in the middle, and a current in 1000 points that no picture shows.
fn report() -> Report {
    let net =
        |title: &str| Net { title: title.to_owned(), nodes: vec![0, 1], ends: Vec::new(), directed: true };
    let wire =
        |n: usize| format!("<g class=\"wire\" data-net=\"{n}\"><path d=\"M60 {0}H140\"/></g>", 20 + 10 * n);
    let svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"200\" height=\"80\" viewBox=\"0 0 200 80\">{}{}{}\
         <g class=\"block\" data-node=\"0\"><path d=\"M10 10h50v60h-50Z\"/></g>\
         <g class=\"block\" data-node=\"1\"><path d=\"M140 10h50v60h-50Z\"/></g></svg>",
        wire(0),
        wire(1),
        wire(2)
    );
    let block = |name: &str| {
        let parameters = vec![["resistance".to_owned(), "2 * r".to_owned(), "0.5 Ω".to_owned()]];
        Some(Inspected {
            name: name.to_owned(),
            kind: "Motor".to_owned(),
            parameters,
            ..Inspected::default()
        })
    };
    let probe = |element: &str, path: &str| Probe { element: element.to_owned(), path: path.to_owned() };
    let probes = vec![
        vec![probe("", "motor.i")],
        vec![
            probe("[1]", "scope.u"),
            probe("[2]", "motor.i"),
            probe("[3]", "scope.u"),
            probe("[4]", "scope.u"),
        ],
        vec![],
    ];
    let nets = ["motor.i -> law.u", "motor.list -> law.list", "motor.w -> law.w"].map(net).to_vec();
    let time: Vec<f64> = (0..1000).map(|k| f64::from(k) * 2.0 / 999.0).collect();
    Report {
        title: "values".to_owned(),
        panels: vec![Panel {
            title: "voltage".to_owned(),
            unit: "V".to_owned(),
            time: vec![0.0, 1.0, 1.0, 2.0],
            series: vec![series("u", vec![0.0, 2.0, 12.0, 14.0])],
            ..Panel::default()
        }],
        unseen: vec![Unseen {
            path: "motor.i".to_owned(),
            unit: "A".to_owned(),
            values: time.iter().map(|t| 733e-6 * (1.0 - (-5.0 * t).exp())).collect(),
            time,
            ..Unseen::default()
        }],
        diagram: Diagram {
            drawings: vec![Drawing { svg, nets, ..Drawing::default() }],
            levels: vec![Level {
                blocks: vec![block("motor"), block("law")],
                probes,
                signals: ["motor.i", "motor.list", "motor.w"].map(|name| Some(name.to_owned())).to_vec(),
                ..Level::default()
            }],
            ..Diagram::default()
        },
        tables: vec![(
            "robot".to_owned(),
            Rows { head: vec!["name".to_owned()], rows: vec![vec!["payload".to_owned()]] },
        )],
        ..Report::default()
    }
}

/// What a script answers in the page of the report above.
fn answer(name: &str, script: &str) -> Option<String> {
    answer_of(&report(), name, script)
}

/// What a script answers in a page.
fn answer_of(report: &Report, name: &str, script: &str) -> Option<String> {
    answered(&with_script(&html(report), script), name, [1280, 3000])
}

#[test]
fn wires_tell_the_values_of_all_recorded_signals_with_readable_units() {
    let script = "await new Promise((ok) => setTimeout(ok, 300));
        R.setTime(2); const on = [...document.querySelectorAll('.value')].map((v) => v.textContent);
        const wire = document.querySelector('[data-net=\"1\"]');
        wire.dispatchEvent(new PointerEvent('pointerenter', { pointerType: 'mouse', clientX: 5, clientY: 5 }));
        const tip = [...document.querySelectorAll('.tip tr')].map((row) => row.textContent);
        R.Diagram.walk(1); R.Diagram.walk(1); R.Diagram.walk(1);
        return [...on, ...tip, document.querySelector('.inspector').textContent].join('\\n');";
    let Some(said) = answer("wires", script) else { return };
    let expected = "733 µA\n[14, 0.000733, 14, … 4] V\n[1]14 V\n[2]733 µA\n[3]14 V\n[4]14 V\n\
                    motor.w -> law.wThis signal was not recorded. In the diagram record: [\"motor.w\"] records it.";
    assert_eq!(said, expected);
}

#[test]
fn numbers_get_the_prefix_that_reads_best_and_no_more_digits_than_they_have() {
    let script = "return [[733e-6, 'A'], [-0.0042, 'N·m'], [12345, 'W'], [2.5e-5, 'mm'], [1234.5, 'rad/s'], [3e-7, 'm²'],
        [0.05, '°'], [7e-8, '°'], [0, 'V'], [NaN, 'V'], [2.5e7, 's'], [5e-16, 'A'], [1e-4, '1/min']].map(([x, u]) => R.quantity(x, u))
        .concat([R.quantity(123.456, 'V', 4, 0.5), R.quantity(0.004, 'V', 4, 0.5), R.quantity(-1.5, 'V', 4, 0.02)]).join('; ');";
    let Some(said) = answer("numbers", script) else { return };
    let expected = "733 µA; −4.2 mN·m; 12.35 kW; 25 nm; 1235 rad/s; 3·10⁻⁷ m²; 0.05 °; 7·10⁻⁸ °; 0 V; – V; 2.5·10⁷ s; \
                    0.0005 pA; 0.0001 1/min; 123.5 V; 0 V; −1.5 V";
    assert_eq!(said, expected);
}

#[test]
fn the_table_has_exact_values_at_and_between_the_cursors_and_saves_what_is_shown() {
    let script = "R.setCursor(0, 0.25); R.setCursor(1, 0.75); R.setTime(2); R.Readings.toggle();
        document.querySelector('#readings input').click(); R.Readings.write();
        const cells = [...document.querySelectorAll('#readings tbody td')].map((cell) => cell.textContent);
        const text = R.Readings.text().split('\\n')[2];
        R.setCursor(0, 0.5); R.setCursor(1, 1.5); const across = R.Readings.text().split('\\n')[2];
        return [cells.join(' '), text, across, R.Readings.csv()].join('\\n');";
    let Some(said) = answer("table", script) else { return };
    let lines: Vec<&str> = said.lines().collect();
    // Of a line from 0.5 to 1.5 the mean square is (0.25 + 0.75 + 2.25) / 3.
    assert_eq!(lines[0], "V 14 0.5 1.5 1 0.5 1.5 1 1.040833");
    assert_eq!(lines[1], "scope.u\tV\t14\t0.5\t1.5\t1\t0.5\t1.5\t1\t1.040833");
    // Two lines, 1 to 2 and 12 to 13: mean 7, mean square (7/3 + 469/3) / 2.
    assert_eq!(
        lines[2],
        format!("scope.u\tV\t14\t1\t13\t12\t1\t13\t7\t{:.6}", (476.0_f64 / 6.0).sqrt()).trim_end_matches('0')
    );
    assert_eq!(lines[3..], ["time [s],scope.u [V]", "0,0", "1,2", "1,12", "2,14"]);
}

#[test]
fn signals_and_parameters_are_found_by_parts_of_their_names_and_gone_to() {
    let script = "const seek = async (text) => { R.Search.open(); const input = document.querySelector('#search input');
          input.value = text; input.dispatchEvent(new Event('input'));
          const found = [...document.querySelectorAll('#found li')].map((li) => li.textContent);
          input.dispatchEvent(new KeyboardEvent('keydown', { key: 'Enter', bubbles: true }));
          return found.slice(0, 3).join(', '); };
        const told = [await seek('motor.i'), document.querySelectorAll('.card').length, document.activeElement.textContent,
          await seek('law resist'), document.querySelector('.inspector tr.chosen').textContent,
          await seek('payload'), document.querySelector('#tables tr.chosen').textContent, await seek('nothing of that kind')];
        return told.join('\\n');";
    let Some(said) = answer("search", script) else { return };
    let expected = "signalmotor.i A (no picture yet)\n2\nmotor.i [A]i 0\nparameterlaw.resistance 2 * r = 0.5 Ω\n\
                    resistance2 * r0.5 Ω\nparameterpayload (robot)\npayload\n";
    assert_eq!(said, expected);
}

#[test]
fn pictures_of_different_length_begin_with_all_times_and_one_value_is_a_dot() {
    let panel = |title: &str, time: Vec<f64>, values: Vec<f64>| Panel {
        title: title.to_owned(),
        time,
        series: vec![series(title, values)],
        ..Panel::default()
    };
    let report = Report {
        panels: vec![
            panel("long", vec![0.0, 5.0], vec![1.0, 2.0]),
            panel("late", vec![2.0, 3.0], vec![1.0, 2.0]),
            panel("one", vec![1.0], vec![7.0]),
            panel("gap", vec![0.0, 1.0, 2.0], vec![f64::NAN, 3.0, f64::NAN]),
            panel("none", vec![], vec![]),
        ],
        ..Report::default()
    };
    // A busy machine takes its time to draw.
    let script = "const until = async (done) => { for (let n = 0; n < 100 && !done(); n++) await new Promise((ok) => setTimeout(ok, 50)); };
        await until(() => R.Plots.panels.length === 5 && R.Plots.panels.every((p) => p.main.scales.x.max === 5)); R.setTime(1);
        await until(() => document.querySelector('.entry b')?.textContent === '1.2');
        const dots = R.Plots.panels.map((p) => p.main.series[1].points.show(p.main, 1));
        return [R.Plots.range(), R.Plots.panels.map((p) => `${p.main.scales.x.min} to ${p.main.scales.x.max}`), dots,
          [...document.querySelectorAll('.entry b')].map((b) => b.textContent)].map((all) => all.join(', ')).join('\\n');";
    let Some(said) = answer_of(&report, "ranges", script) else { return };
    let all = "0 to 5, 0 to 5, 0 to 5, 0 to 5, 0 to 5";
    assert_eq!(said, format!("0, 5\n{all}\nfalse, false, true, true, false\n1.2, –, 7, 3, –"));
}

#[test]
fn truth_values_have_a_lane_each_and_keep_their_values() {
    let truth = |name: &str, values: Vec<f64>| Series { held: true, ..series(name, values) };
    let report = Report {
        panels: vec![Panel {
            title: "gates".to_owned(),
            time: vec![0.0, 1.0, 2.0],
            series: vec![truth("gate[0]", vec![0.0, 1.0, 0.0]), truth("gate[1]", vec![1.0, 0.0, 1.0])],
            ..Panel::default()
        }],
        ..Report::default()
    };
    // A busy machine takes its time to draw.
    let script = "const [panel] = R.Plots.panels; R.setTime(1);
        for (let n = 0; n < 100 && document.querySelector('.entry b')?.textContent !== '1'; n++) await new Promise((ok) => setTimeout(ok, 50));
        return [panel.lanes, [...panel.main.data[1]], [...panel.main.data[2]],
          [...document.querySelectorAll('.entry b')].map((b) => b.textContent)].map((all) => all.join(', ')).join('\\n');";
    let Some(said) = answer_of(&report, "lanes", script) else { return };
    assert_eq!(said, "[0], [1]\n1, 1.7, 1\n0.7, 0, 0.7\n1, 0");
}

/// A page with a pair and as many other pictures as wanted.
fn pictures(others: usize) -> Report {
    let time = vec![0.0, 0.5, 1.0];
    let of_pair = |name: &str, role, values| Series { role, ..series(name, values) };
    let pair = Panel {
        title: "axis1".to_owned(),
        time: time.clone(),
        series: vec![
            of_pair("set", Role::Set, vec![0.0, 1.0, 1.0]),
            of_pair("actual", Role::Actual, vec![0.0, 0.9, 1.0]),
        ],
        ..Panel::default()
    };
    let other = |n: usize| Panel {
        title: format!("other{n}"),
        time: time.clone(),
        series: vec![series("x", vec![1.0, 2.0, 3.0])],
        ..Panel::default()
    };
    let panels = std::iter::once(pair).chain((0..others).map(other)).collect();
    Report { panels, ..Report::default() }
}

#[test]
fn bars_have_two_rows_at_most_on_a_phone() {
    // The window of a browser is never as narrow as a phone, a frame within it may be.
    let script = "const rows = (place) => new Set([...document.querySelector(place).children].map((c) => c.getBoundingClientRect())
          .filter((box) => box.width > 0).map((box) => Math.round((box.top + box.bottom) / 2 / 12))).size;
        if (self !== top) {
          const wide = (place) => document.querySelector(place).getBoundingClientRect().width > 60;
          const before = [innerWidth, rows('.bar') <= 2, rows('#timeline') <= 2 && wide('.clock')];
          R.setCursor(0, 0.25); R.setCursor(1, 0.75);
          await new Promise((ok) => setTimeout(ok, 100));
          const fits = document.documentElement.scrollWidth <= innerWidth;
          top.postMessage([...before, rows('#timeline') <= 2 && wide('.readout'), fits].join(', '), '*');
          return 'inside';
        }
        const told = new Promise((ok) => addEventListener('message', (event) => ok(event.data)));
        const frame = document.createElement('iframe');
        frame.style.width = '360px'; frame.style.height = '700px'; frame.style.border = '0';
        frame.src = location.href;
        document.body.append(frame);
        return await told;";
    let Some(said) = answer_of(&pictures(1), "phone", script) else { return };
    assert_eq!(said, "360, true, true, true, true");
}

#[test]
fn pictures_leave_no_holes_and_four_rows_of_them_fit_on_paper() {
    let script = "const right = () => [...document.querySelectorAll('.grid')].map((grid) => {
          const end = grid.getBoundingClientRect().right;
          const last = [...grid.children].at(-1).getBoundingClientRect().right;
          return Math.abs(end - last) < 1;
        });
        const before = right(), screen = R.Plots.panels[0].main.height;
        dispatchEvent(new Event('beforeprint'));
        await new Promise((ok) => setTimeout(ok, 100));
        // A page of A4 less its margins, at 96 dots an inch.
        const card = document.querySelector('.card').offsetHeight;
        const printed = [right(), 4 * card < 1047, 5 * card > 1047];
        dispatchEvent(new Event('afterprint'));
        return [before, ...printed, R.Plots.panels[0].main.height === screen].join(', ');";
    for others in [0, 1, 2, 3] {
        let Some(said) = answer_of(&pictures(others), "paper", script) else { return };
        assert_eq!(said, "true, true, true, true, true", "{others}");
    }
}
