use super::*;
use crate::plot::decimate::thinned;
use crate::plot::figure::Strip;
use expect_test::expect;

fn figure() -> Figure {
    let line = |name: &str, style, end: f64| Line {
        name: name.to_owned(),
        style,
        courses: vec![vec![(0.0, 0.0), (2.0, end)]],
        ..Line::default()
    };
    Figure {
        title: String::new(),
        panels: vec![Panel {
            title: "joint1".to_owned(),
            unit: "deg".to_owned(),
            lines: vec![line("set", Style::Dashed, 60.0), line("actual", Style::Solid, 58.0)],
            strip: Some(Strip { name: "error".to_owned(), lines: vec![line("", Style::Solid, 2.0)] }),
            plane: None,
            notes: Vec::new(),
        }],
        columns: 1,
        across: Across::Time,
        time: (0.0, 2.0),
        width: 320.0,
    }
}

#[test]
fn a_small_figure_reads_like_this() {
    expect![[r##"
        <svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 320 296" width="320" height="296" font-family="system-ui, 'Segoe UI', 'DejaVu Sans', sans-serif" role="img">
        <title>Signals over time</title>
        <desc>joint1 [deg]: set, actual</desc>
        <rect width="320" height="296" fill="#FFFFFF"/>
        <text x="37.36" y="27" font-size="13" fill="#0F172A" font-weight="bold">joint1 [°]</text>
        <path d="M116.68 23H138.68" fill="none" stroke="#0F172A" stroke-width="1.1" stroke-linecap="butt" stroke-dasharray="6 4"/>
        <text x="143.68" y="27" font-size="11" fill="#0F172A">set</text>
        <path d="M174.49 23H196.49" fill="none" stroke="#5800FF" stroke-width="1.7" stroke-linecap="round"/>
        <text x="201.49" y="27" font-size="11" fill="#0F172A">actual</text>
        <text x="32.36" y="182.94" font-size="10.5" fill="#475569" text-anchor="end">0</text>
        <text x="32.36" y="136.65" font-size="10.5" fill="#475569" text-anchor="end">20</text>
        <text x="32.36" y="90.35" font-size="10.5" fill="#475569" text-anchor="end">40</text>
        <text x="32.36" y="44.06" font-size="10.5" fill="#475569" text-anchor="end">60</text>
        <path d="M37.36 35V185M168.68 35V185M300 35V185M37.36 179.44H300M37.36 133.15H300M37.36 86.85H300M37.36 40.56H300" stroke="#E2E8F0" fill="none"/>
        <svg class="courses" x="37.36" y="35" width="262.64" height="150" viewBox="37.36 35 262.64 150" stroke-linejoin="round">
        <path d="M37.36 179.44L300 45.19" fill="none" stroke="#5800FF" stroke-width="1.7" stroke-linecap="round"/>
        <path d="M37.36 179.44L300 40.56" fill="none" stroke="#0F172A" stroke-width="1.1" stroke-linecap="butt" stroke-dasharray="6 4"/>
        </svg>
        <rect x="37.36" y="35" width="262.64" height="150" fill="none" stroke="#94A3B8"/>
        <text x="32.36" y="249.8" font-size="10.5" fill="#475569" text-anchor="end">0</text>
        <text x="32.36" y="207.2" font-size="10.5" fill="#475569" text-anchor="end">2</text>
        <path d="M37.36 202V248M168.68 202V248M300 202V248M37.36 246.3H300M37.36 203.7H300" stroke="#E2E8F0" fill="none"/>
        <svg class="courses" x="37.36" y="202" width="262.64" height="46" viewBox="37.36 202 262.64 46" stroke-linejoin="round">
        <path d="M37.36 246.3L300 203.7" fill="none" stroke="#5800FF" stroke-width="1.7" stroke-linecap="round"/>
        </svg>
        <rect x="37.36" y="202" width="262.64" height="46" fill="none" stroke="#94A3B8"/>
        <text x="39.36" y="198" font-size="10.5" fill="#475569">error</text>
        <text x="37.36" y="262" font-size="10.5" fill="#475569" text-anchor="middle">0</text>
        <text x="168.68" y="262" font-size="10.5" fill="#475569" text-anchor="middle">1</text>
        <text x="300" y="262" font-size="10.5" fill="#475569" text-anchor="middle">2</text>
        <text x="168.68" y="276" font-size="10.5" fill="#475569" text-anchor="middle">time [s]</text>
        </svg>
    "##]].assert_eq(&svg(&figure(), Theme::Light));
}

#[test]
fn names_cannot_add_anything_to_the_drawing() {
    let evil = "</text><script>alert('x')</script>\"&\u{0}\u{1b}";
    let mut figure = figure();
    figure.title = evil.to_owned();
    figure.panels[0].title = evil.to_owned();
    figure.panels[0].unit = evil.to_owned();
    figure.panels[0].notes.push(evil.to_owned());
    figure.panels[0].lines[0].name = evil.to_owned();
    for theme in [Theme::Light, Theme::Dark] {
        let text = svg(&figure, theme);
        assert!(!text.contains("<script"), "{text}");
        crate::png(&text, 1.0).unwrap();
    }
}

#[test]
fn every_drawing_can_be_made_a_picture_whatever_the_values() {
    let extremes = [0.0, f64::MAX, f64::MIN, f64::NAN, 5e-324, f64::INFINITY, -1.0];
    let time: Vec<f64> = (0..extremes.len()).map(|k| k as f64).collect();
    for range in [(0.0, 6.0), (3.0, 3.0), (f64::NAN, 1.0), (5.0, 2.0), (-1e300, 1e300)] {
        let mut figure = figure();
        figure.time = range;
        figure.panels[0].lines[0].courses = thinned(&time, &extremes, &(range.0..=range.1), 100, false);
        figure.panels[0].lines[1].courses.clear();
        figure.panels[0].strip = None;
        let text = svg(&figure, Theme::Dark);
        assert!(!text.contains("NaN") && !text.contains("inf"), "{text}");
        crate::png(&text, 1.0).unwrap();
    }
    crate::png(&svg(&Figure { width: 100.0, ..Figure::default() }, Theme::Light), 1.0).unwrap();
}

#[test]
fn panels_above_each_other_share_their_axis_of_time() {
    let mut figure = figure();
    figure.panels.push(figure.panels[0].clone());
    figure.panels[1].lines[0].courses = vec![vec![(0.0, 0.0), (2.0, 1234.5)]];
    let text = svg(&figure, Theme::Light);
    let lefts: Vec<&str> = text
        .lines()
        .filter_map(|line| line.strip_prefix("<svg class=\"courses\" x=\"")?.split('"').next())
        .collect();
    assert_eq!(lefts.len(), 4, "two pictures and two strips");
    assert!(lefts.iter().all(|left| *left == lefts[0]), "{lefts:?}");
}

#[test]
fn two_drawings_can_stand_in_one_page() {
    assert!(!svg(&figure(), Theme::Light).contains(" id=\""), "names would clash");
}

/// Left, top, width and height of all plots and strips.
fn areas(text: &str) -> Vec<[f64; 4]> {
    let number = |line: &str, name: &str| -> f64 {
        line.split(&format!(" {name}=\""))
            .nth(1)
            .and_then(|rest| rest.split('"').next())
            .unwrap()
            .parse()
            .unwrap()
    };
    let plots = text.lines().filter(|line| line.starts_with("<svg class=\"courses\""));
    plots.map(|line| ["x", "y", "width", "height"].map(|name| number(line, name))).collect()
}

#[test]
fn a_grid_has_no_holes() {
    for (count, columns) in [(1, 2), (2, 2), (3, 2), (5, 2), (4, 3), (5, 3), (7, 4)] {
        let mut figure = Figure { width: 960.0, columns, ..figure() };
        let panel = figure.panels[0].clone();
        // Every other panel has no strip.
        let lower = Panel { strip: None, ..panel.clone() };
        figure.panels = (0..count).map(|n| if n % 2 == 0 { panel.clone() } else { lower.clone() }).collect();
        let areas = areas(&svg(&figure, Theme::Light));
        let mut tops: Vec<f64> = areas.iter().filter(|area| area[3] > 100.0).map(|area| area[1]).collect();
        tops.dedup();
        assert_eq!(tops.len(), usize::div_ceil(count, columns), "{areas:?}");
        for (row, top) in tops.iter().enumerate() {
            let next = tops.get(row + 1).copied().unwrap_or(f64::INFINITY);
            let row: Vec<&[f64; 4]> = areas.iter().filter(|area| area[1] >= *top && area[1] < next).collect();
            let end = |fold: fn(f64, f64) -> f64, of: &dyn Fn(&[f64; 4]) -> f64| {
                row.iter().map(|area| of(area)).reduce(fold).unwrap()
            };
            // The whole width is used, and all panels end at the same height.
            assert!((end(f64::max, &|area| area[0] + area[2]) - 940.0).abs() < 0.1, "{row:?}");
            let lefts = areas.iter().map(|area| area[0]).reduce(f64::min).unwrap();
            assert_eq!(end(f64::min, &|area| area[0]), lefts);
            let bottom = end(f64::max, &|area| area[1] + area[3]);
            let mut ends: Vec<f64> = Vec::new();
            for panel in row.iter().filter(|area| area[3] > 100.0) {
                let own = row.iter().filter(|area| area[0] == panel[0]);
                ends.push(own.map(|area| area[1] + area[3]).reduce(f64::max).unwrap());
            }
            assert!(ends.iter().all(|end| (end - bottom).abs() < 0.02), "{ends:?}");
        }
    }
}

#[test]
fn pages_are_no_longer_than_paper_and_lose_nothing() {
    let mut whole = Figure { width: 960.0, columns: 2, title: "Arm".to_owned(), ..figure() };
    let panel = whole.panels[0].clone();
    whole.panels = (0..23).map(|n| Panel { title: format!("joint{n}"), ..panel.clone() }).collect();
    let parts = pages(&whole);
    assert!(parts.len() > 1);
    let titles = |figure: &Figure| figure.panels.iter().map(|p| p.title.clone()).collect::<Vec<_>>();
    assert_eq!(parts.iter().flat_map(titles).collect::<Vec<_>>(), titles(&whole));
    for (n, part) in parts.iter().enumerate() {
        let text = svg(part, Theme::Light);
        let height = text.split("height=\"").nth(1).and_then(|rest| rest.split('"').next()).unwrap();
        assert!(height.parse::<f64>().unwrap() <= 960.0 * std::f64::consts::SQRT_2 + 1.0, "{height}");
        assert!(
            n + 1 == parts.len() || part.panels.len() % 2 == 0,
            "only the last page may have a row that is not full"
        );
        assert_eq!(part.title, "Arm");
    }
    assert_eq!(pages(&figure()), [figure()]);
    assert_eq!(pages(&Figure::default()).len(), 1);
}
