//! The colours of series, held to what they promise: everybody can tell them apart, and from the ground.

use blocksim_picture::{Palette, Theme};

type Rgb = [f64; 3];

/// Rows of the matrices for full protanopia, deuteranopia and tritanopia: Machado, Oliveira and Fernandes, "A
/// Physiologically-based Model for Simulation of Color Vision Deficiency", IEEE TVCG 15 (2009), table 1.
const MACHADO: [(&str, [Rgb; 3]); 3] = [
    (
        "protan",
        [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]],
    ),
    (
        "deutan",
        [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.011820, 0.042940, 0.968881]],
    ),
    (
        "tritan",
        [[1.255528, -0.076749, -0.178779], [-0.078411, 0.930809, 0.147602], [0.004733, 0.691367, 0.303900]],
    ),
];

/// Linear light of a colour `#RRGGBB` in sRGB (IEC 61966-2-1).
fn linear(colour: &str) -> Rgb {
    [1, 3, 5].map(|at| {
        let byte = u8::from_str_radix(&colour[at..at + 2], 16).expect("two digits");
        let x = f64::from(byte) / 255.0;
        if x <= 0.04045 { x / 12.92 } else { ((x + 0.055) / 1.055).powf(2.4) }
    })
}

fn seen(colour: Rgb, matrix: &[Rgb; 3]) -> Rgb {
    matrix.map(|row| row.iter().zip(colour).map(|(a, b)| a * b).sum::<f64>().clamp(0.0, 1.0))
}

/// CIE L*a*b* for the white point D65.
fn lab([r, g, b]: Rgb) -> Rgb {
    let x = (0.4124564 * r + 0.3575761 * g + 0.1804375 * b) / 0.95047;
    let y = 0.2126729 * r + 0.7151522 * g + 0.0721750 * b;
    let z = (0.0193339 * r + 0.1191920 * g + 0.9503041 * b) / 1.08883;
    let f = |t: f64| if t > 216.0 / 24389.0 { t.cbrt() } else { (24389.0 / 27.0 * t + 16.0) / 116.0 };
    [116.0 * f(y) - 16.0, 500.0 * (f(x) - f(y)), 200.0 * (f(y) - f(z))]
}

/// Difference of two colours, CIEDE2000: Sharma, Wu and Dalal, Color Research and Application 30 (2005), equations 2
/// to 22.
fn ciede2000([l1, a1, b1]: Rgb, [l2, a2, b2]: Rgb) -> f64 {
    let mean_c = (a1.hypot(b1) + a2.hypot(b2)) / 2.0;
    let g = 0.5 * (1.0 - (mean_c.powi(7) / (mean_c.powi(7) + 25_f64.powi(7))).sqrt());
    let (a1, a2) = ((1.0 + g) * a1, (1.0 + g) * a2);
    let (c1, c2) = (a1.hypot(b1), a2.hypot(b2));
    let hue =
        |a: f64, b: f64| if a == 0.0 && b == 0.0 { 0.0 } else { b.atan2(a).to_degrees().rem_euclid(360.0) };
    let (h1, h2) = (hue(a1, b1), hue(a2, b2));
    let grey = c1 * c2 == 0.0;
    let dh = match h2 - h1 {
        _ if grey => 0.0,
        d if d > 180.0 => d - 360.0,
        d if d < -180.0 => d + 360.0,
        d => d,
    };
    let dh = 2.0 * (c1 * c2).sqrt() * (dh / 2.0).to_radians().sin();
    let h = match h1 + h2 {
        sum if grey => sum,
        sum if (h1 - h2).abs() <= 180.0 => sum / 2.0,
        sum if sum < 360.0 => (sum + 360.0) / 2.0,
        sum => (sum - 360.0) / 2.0,
    };
    let (l, c) = ((l1 + l2) / 2.0, (c1 + c2) / 2.0);
    let cos = |x: f64| x.to_radians().cos();
    let t = 1.0 - 0.17 * cos(h - 30.0) + 0.24 * cos(2.0 * h) + 0.32 * cos(3.0 * h + 6.0)
        - 0.20 * cos(4.0 * h - 63.0);
    let turn = 30.0 * (-((h - 275.0) / 25.0).powi(2)).exp();
    let rc = 2.0 * (c.powi(7) / (c.powi(7) + 25_f64.powi(7))).sqrt();
    let sl = 1.0 + 0.015 * (l - 50.0).powi(2) / (20.0 + (l - 50.0).powi(2)).sqrt();
    let (sc, sh) = (1.0 + 0.045 * c, 1.0 + 0.015 * c * t);
    let rt = -(2.0 * turn).to_radians().sin() * rc;
    let (x, y, z) = ((l2 - l1) / sl, (c2 - c1) / sc, dh / sh);
    (x * x + y * y + z * z + rt * y * z).sqrt()
}

/// WCAG 2.1, contrast ratio.
fn contrast(a: &str, b: &str) -> f64 {
    let light = |colour: &str| {
        let [r, g, b] = linear(colour);
        0.2126 * r + 0.7152 * g + 0.0722 * b
    };
    let (a, b) = (light(a), light(b));
    (a.max(b) + 0.05) / (a.min(b) + 0.05)
}

#[test]
fn ciede2000_agrees_with_the_published_pairs() {
    // Pairs 1, 7, 13, 17, 25 and 33 of the test data of Sharma, Wu and Dalal.
    for (a, b, expected) in [
        ([50.0, 2.6772, -79.7751], [50.0, 0.0, -82.7485], 2.0425),
        ([50.0, 0.0, 0.0], [50.0, -1.0, 2.0], 2.3669),
        ([50.0, -0.0010, 2.4900], [50.0, 0.0009, -2.4900], 4.8045),
        ([50.0, 2.5, 0.0], [73.0, 25.0, -18.0], 27.1492),
        ([60.2574, -34.0099, 36.2677], [60.4626, -34.1751, 39.4387], 1.2644),
        ([6.7747, -0.2908, -2.4247], [5.8714, -0.0985, -2.2286], 0.6377),
    ] {
        let found = ciede2000(a, b);
        assert!((found - expected).abs() < 1e-4, "{a:?} {b:?}: {found} is not {expected}");
    }
}

#[test]
fn series_differ_for_every_kind_of_sight() {
    for theme in [Theme::Light, Theme::Dark] {
        let colours = Palette::of(theme).series.map(linear);
        let identity = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        for (sight, matrix) in MACHADO.iter().chain([&("normal", identity)]) {
            let labs = colours.map(|colour| lab(seen(colour, matrix)));
            for (n, a) in labs.iter().enumerate() {
                for (m, b) in labs.iter().enumerate().skip(n + 1) {
                    let difference = ciede2000(*a, *b);
                    assert!(
                        difference >= 20.0,
                        "{theme:?}, {sight}: {} and {} by {difference:.1}",
                        n + 1,
                        m + 1
                    );
                }
            }
        }
    }
}

#[test]
fn lines_stand_out_from_the_ground_and_letters_more_so() {
    for theme in [Theme::Light, Theme::Dark] {
        let palette = Palette::of(theme);
        for colour in palette.series {
            let found = contrast(colour, palette.ground);
            assert!(found >= 3.0, "{theme:?}: {colour} has {found:.2}");
        }
        for letters in [palette.text, palette.quiet, palette.alarm] {
            assert!(contrast(letters, palette.ground) >= 4.5, "{theme:?}: {letters}");
        }
    }
    assert!((contrast("#000000", "#FFFFFF") - 21.0).abs() < 1e-9);
}
