//! Colours that people with any kind of sight can tell apart.

/// On which ground is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Theme {
    /// Dark on white.
    #[default]
    Light,
    /// Light on dark blue.
    Dark,
}

/// Colours as `#RRGGBB`.
///
/// The six colours of series differ by at least 20 in CIEDE2000 for normal, protanope, deuteranope and tritanope sight
/// (simulated after Machado, Oliveira and Fernandes 2009), and have a contrast of at least 3 to 1 against the ground
/// (WCAG 2.1, 1.4.11). A test computes both.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Palette {
    /// The ground.
    pub ground: &'static str,
    /// Titles and names.
    pub text: &'static str,
    /// Numbers at the axes.
    pub quiet: &'static str,
    /// Frame of a panel.
    pub frame: &'static str,
    /// Lines of the grid.
    pub grid: &'static str,
    /// What is wrong.
    pub alarm: &'static str,
    /// Series 1 to 6: joint 1 has the first colour everywhere.
    pub series: [&'static str; 6],
}

const LIGHT: Palette = Palette {
    ground: "#FFFFFF",
    text: "#0F172A",
    quiet: "#475569",
    frame: "#94A3B8",
    grid: "#E2E8F0",
    alarm: "#B00020",
    series: ["#5800FF", "#EE6700", "#105A53", "#A28295", "#0797FD", "#770700"],
};

const DARK: Palette = Palette {
    ground: "#0F172A",
    text: "#F1F5F9",
    quiet: "#A8B4C6",
    frame: "#64748B",
    grid: "#26334A",
    alarm: "#FF8A80",
    series: ["#7E37FA", "#DDB227", "#3BFFCC", "#D1C9FF", "#0A7970", "#BC4000"],
};

impl Palette {
    /// The colours for a ground.
    pub fn of(theme: Theme) -> Palette {
        match theme {
            Theme::Light => LIGHT,
            Theme::Dark => DARK,
        }
    }
}
