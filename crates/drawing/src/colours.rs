//! Colours of a drawing: elements say their role by a class, one style sheet says what a role looks like.

use blocksim_block::physical::Domain;
use blocksim_picture::{Palette, Theme};

/// Font of all texts; the last one is what pictures in PNG are drawn with.
pub(crate) const FONT: &str = "system-ui,'Segoe UI','DejaVu Sans',sans-serif";

/// The colour of a line, a letter or a sign.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Colour {
    /// As what is around it: blocks and signals.
    Ink,
    /// Names and axes.
    Quiet,
    /// What a conserving connection carries.
    Of(Domain),
}

impl Colour {
    pub fn of(domain: Option<Domain>) -> Colour {
        domain.map_or(Colour::Ink, Colour::Of)
    }

    /// The class of the style sheet.
    pub fn class(self) -> &'static str {
        match self {
            Colour::Ink => "",
            Colour::Quiet => "quiet",
            Colour::Of(Domain::Frame) => "frames",
            Colour::Of(Domain::ThreePhase) => "phases",
            Colour::Of(Domain::Rotational) => "turning",
            Colour::Of(Domain::Electrical) => "electric",
            Colour::Of(Domain::Translational) => "sliding",
            Colour::Of(Domain::Thermal) => "thermal",
            Colour::Of(Domain::Magnetic) => "magnetic",
            Colour::Of(Domain::Hydraulic) => "hydraulic",
        }
    }
}

/// What a shape is filled with.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Fill {
    Nothing,
    /// The ground of the drawing.
    Ground,
    /// The inside of subsystems and bodies.
    Inside,
    /// The colour of its lines.
    Solid,
}

/// Names of the variables of a page and the colours of a theme, in the order of the rules below.
fn roles(theme: Theme) -> [(&'static str, &'static str); 12] {
    let Palette { ground, text, quiet, grid, series, .. } = Palette::of(theme);
    // Thin lines on a dark ground want brighter colours than plots have.
    let (inside, frames, electric, sliding, thermal) = match theme {
        Theme::Light => ("#F1F5F9", series[0], series[4], series[5], "#BE123C"),
        Theme::Dark => (grid, "#B69CFF", "#1E9BFF", "#FF8A5C", "#FB7185"),
    };
    let (magnetic, hydraulic) = match theme {
        Theme::Light => ("#86198F", "#155E75"),
        Theme::Dark => ("#E879F9", "#67E8F9"),
    };
    [
        ("ground", ground),
        ("ink", text),
        ("quiet", quiet),
        ("inside", inside),
        ("frames", frames),
        ("phases", series[1]),
        ("turning", series[2]),
        ("electric", electric),
        ("sliding", sliding),
        ("thermal", thermal),
        ("magnetic", magnetic),
        ("hydraulic", hydraulic),
    ]
}

/// The rules for all drawings, with the colour of each role.
fn rules(colour: impl Fn(&str) -> String) -> String {
    let mut out = format!(
        ".diagram{{color:{};fill:none;stroke:currentColor;stroke-width:1.2;stroke-linejoin:round}}\
         .diagram .text,.diagram .dot{{fill:currentColor;stroke:none}}\
         .diagram .solid{{fill:currentColor}}\
         .diagram .wire,.diagram .bus,.diagram .conserving{{stroke-linecap:square}}\
         .diagram .ground{{fill:{};stroke:none}}\
         .diagram .hollow{{fill:{}}}\
         .diagram .inside{{fill:{}}}",
        colour("ink"),
        colour("ground"),
        colour("ground"),
        colour("inside")
    );
    for role in
        ["quiet", "frames", "phases", "turning", "electric", "sliding", "thermal", "magnetic", "hydraulic"]
    {
        out.push_str(&format!(".diagram .{role}{{color:{}}}", colour(role)));
    }
    out
}

/// The rule for what is pointed at. It stands out by its width as well, for those who see no colours.
pub(crate) fn marked(theme: Theme) -> String {
    let colour = roles(theme).iter().find(|(name, _)| *name == "electric").map_or("", |(_, colour)| colour);
    format!(".diagram .marked{{color:{colour};stroke-width:2.4}}")
}

/// The style sheet of a drawing of its own.
pub(crate) fn fixed(theme: Theme) -> String {
    let roles = roles(theme);
    rules(|role| {
        roles.iter().find(|(name, _)| *name == role).map_or_else(String::new, |(_, c)| (*c).to_owned())
    })
}

/// The style sheet for a page that holds drawings made by [`inline`](crate::inline). Each colour is a variable of the
/// page, `--diagram-ink`, `--diagram-ground`, `--diagram-quiet`, `--diagram-inside`, `--diagram-frames`,
/// `--diagram-phases`, `--diagram-turning`, `--diagram-electric`, `--diagram-sliding`, `--diagram-thermal`, `--diagram-magnetic`, `--diagram-hydraulic`; see [`style_variables`].
pub fn style_sheet() -> String {
    rules(|role| format!("var(--diagram-{role})"))
}

/// The colours of a theme as declarations of the variables that [`style_sheet`] needs: `--diagram-ink:#0F172A;...`.
pub fn style_variables(theme: Theme) -> String {
    roles(theme).iter().map(|(role, colour)| format!("--diagram-{role}:{colour};")).collect()
}
