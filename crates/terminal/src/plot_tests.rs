use super::*;
use expect_test::expect;

fn times(n: u32, end: f64) -> Vec<f64> {
    (0..n).map(|k| end * f64::from(k) / f64::from(n - 1)).collect()
}

#[test]
fn two_series_are_drawn_in_braille_and_named_at_their_ends() {
    let t = times(500, 10.0);
    let rise: Vec<f64> = t.iter().map(|t| 75.0 * ((t - 5.0) / 1.5).tanh()).collect();
    let wave: Vec<f64> = t.iter().map(|t| 40.0 * t.sin()).collect();
    let series = [
        Series { name: "q1 [deg]", x: &t, y: &rise, step: false },
        Series { name: "q2 [deg]", x: &t, y: &wave, step: false },
    ];
    let options = PlotOptions { title: "Joint angles", y_label: "angle [deg]", ..Default::default() };
    expect![[r#"
        Joint angles
        angle [deg]
              │                                            ⣀⣀⣀⡠⠤⠤⠤⠤⠤⠤⠤⠤⠤⠤⠤⠤⠤  q1 [deg]
              │                                      ⢀⣠⠴⠒⠋⠉⠁
           50 ┤                                    ⣠⠖⠉
              │    ⢀⡠⠖⠚⠉⠉⠉⠉⠒⠤⣀                  ⢀⡤⠊⠁     ⢀⣠⠔⠊⠉⠉⠉⠙⠒⠦⣀
              │  ⣠⠔⠋         ⠈⠓⢆⡀              ⣠⠊      ⣠⠔⠋         ⠈⠓⢤⡀
              │⣠⠞⠁              ⠙⢦⡀          ⢠⠞⠁     ⣠⠞⠁              ⠙⢦⡀
            0 ┤⠁                  ⠙⢦⡀      ⢀⡴⠃     ⣠⠞⠁                  ⠙⢦⡀
              │                     ⠙⠢⣄   ⡠⠋    ⢀⡤⠚⠁                      ⠉⠲  q2 [deg]
              │                       ⠈⢑⡦⢾⣁⣀⣀⣀⠤⠞⠉
          -50 ┤                      ⣀⠴⠋
              │                ⢀⣀⣠⠤⠖⠋⠁
              │⠒⠒⠒⠒⠒⠒⠒⠒⠒⠒⠒⠒⠒⠊⠉⠉⠉
              └┬───────────┬───────────┬───────────┬───────────┬───────────┬
               0           2           4           6           8          10  time [s]
    "#]]
    .assert_eq(&plot(&series, &options));
}

#[test]
fn a_sampled_signal_is_drawn_in_steps() {
    let t = times(6, 5.0);
    let y = [0.0, 1.0, 1.0, 3.0, 2.0, 2.0];
    let series = [Series { name: "u", x: &t, y: &y, step: true }];
    let options = PlotOptions { title: "Steps", width: 50, height: 8, ..Default::default() };
    expect![[r#"
        Steps
          3 ┤                       ⢸⠉⠉⠉⠉⠉⠉⠉⢹
            │                       ⢸       ⢸
          2 ┤                       ⢸       ⠸⠤⠤⠤⠤⠤⠤⠤⠤  u
            │                       ⢸
            │                       ⢸
          1 ┤        ⡖⠒⠒⠒⠒⠒⠒⠒⠒⠒⠒⠒⠒⠒⠒⠚
            │        ⡇
          0 ┤⣀⣀⣀⣀⣀⣀⣀⣀⡇
            └┬───────────────┬──────────────┬────────
             0               2              4  time [s]
    "#]]
    .assert_eq(&plot(&series, &options));
}

#[test]
fn ascii_has_a_mark_per_series() {
    let t = times(100, 0.002);
    let y1: Vec<f64> = t.iter().map(|t| 1e-6 * (3000.0 * t).sin()).collect();
    let y2: Vec<f64> = t.iter().map(|t| 1e-6 * (1.0 - (-2000.0 * t).exp())).collect();
    let series = [
        Series { name: "current", x: &t, y: &y1, step: false },
        Series { name: "charge", x: &t, y: &y2, step: false },
    ];
    let options = PlotOptions { title: "ASCII", width: 60, height: 9, ascii: true, ..Default::default() };
    let text = plot(&series, &options);
    assert!(text.is_ascii());
    expect![[r#"
        ASCII
           1.0e-6 +       *******     +++++++++++++++++++  + charge
                  |    ***  +++++++++++
           0.5e-6 +   *++++++     ***
                  | ++++            **
                0 +++                 **
                  |                    ***              *  * current
          -0.5e-6 +                      **           **
                  |                        ***      **
          -1.0e-6 +                          *******
                  ++------------------+-----------------+
                 0.000              0.001             0.002  time [s]
    "#]]
    .assert_eq(&text);
}

#[test]
fn constants_gaps_and_missing_values_are_shown_and_told() {
    let t = times(40, 4.0);
    let constant = vec![2.5; 40];
    let mut gap: Vec<f64> = t.iter().map(|t| 2.4 + 0.05 * t).collect();
    gap[15..25].fill(f64::NAN);
    let nothing = vec![f64::INFINITY; 40];
    let series = [
        Series { name: "constant", x: &t, y: &constant, step: false },
        Series { name: "gap", x: &t, y: &gap, step: false },
        Series { name: "lost", x: &t, y: &nothing, step: false },
        Series { name: "empty", x: &[], y: &[], step: false },
    ];
    let options = PlotOptions { title: "Gaps", width: 60, height: 6, ..Default::default() };
    expect![[r#"
        Gaps
          2.6 ┤                                   ⣀⠤⠤⠒⠒⠉  gap
              │                           ⢀⡠⠤⠔⠒⠊⠉⠉
              │                          ⠉⠁
          2.5 ┤⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉⣉⣉⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉  constant
              │     ⢀⣀⣀⠤⠤⠒⠒⠉
          2.4 ┤⡠⠤⠔⠒⠊⠁
              └┬─────────┬─────────┬─────────┬─────────┬
               0         1         2         3         4  time [s]
          gap: NaN first at 1.5385; 10 of 40 values are not finite
          lost: infinite first at 0; 40 of 40 values are not finite
          empty: no values
    "#]]
    .assert_eq(&plot(&series, &options));
    expect![[r#"
        Gaps
              │
          2.6 ┤
              │
              │⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉  constant
          2.4 ┤
              │
              └┬─────────┬─────────┬─────────┬─────────┬
               0         1         2         3         4  time [s]
    "#]]
    .assert_eq(&plot(&series[..1], &options));
}

#[test]
fn nothing_at_all_is_said() {
    assert_eq!(
        plot(&[], &PlotOptions { title: "Empty", ..Default::default() }),
        "Empty\n  nothing to draw\n"
    );
    let lost = [Series { name: "y", x: &[1.0], y: &[f64::NAN], step: false }];
    assert_eq!(
        plot(&lost, &PlotOptions::default()),
        "  nothing to draw\n  y: NaN first at 1.0000; 1 of 1 values are not finite\n"
    );
}

#[test]
fn no_series_and_no_size_make_it_panic() {
    let extremes = [f64::MIN, 0.0, 5e-324, f64::MAX, f64::NAN, f64::INFINITY, -1e-300];
    for x in [&[0.0; 7], &[0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0], &extremes] {
        for width in [0, 1, 20, 300] {
            for height in [0, 1, 3, 50] {
                for ascii in [false, true] {
                    let series = [Series { name: "y", x, y: &extremes, step: true }; 9];
                    let text = plot(&series, &PlotOptions { width, height, ascii, ..Default::default() });
                    assert!(text.contains('y'));
                }
            }
        }
    }
}

#[test]
fn lines_keep_to_the_width() {
    let t = times(100, 123.0);
    let series = [Series { name: "control/joint1/scope.set", x: &t, y: &t, step: false }];
    for width in [60, 80, 120] {
        let text = plot(&series, &PlotOptions { width, ..Default::default() });
        let longest = text.lines().map(|l| l.chars().count()).max().unwrap();
        assert!(longest <= width, "{longest} > {width}\n{text}");
    }
}
