//! Curves over time, and of outputs over inputs.

use blocksim_block::Curve;

use super::Pen;
use crate::canvas::Paint;
use crate::colours::{Colour, Fill};

pub(super) fn draw(pen: &mut Pen, curve: Curve) {
    let over_input = matches!(
        curve,
        Curve::Saturation
            | Curve::DeadZone
            | Curve::Relay
            | Curve::Quantizer
            | Curve::Backlash
            | Curve::Sign
            | Curve::Table
            | Curve::RateLimit
    );
    let axes = if over_input { "M-15 0H15M0 -12V12" } else { "M-14 11H15M-14 11V-12" };
    let paint = Paint { colour: Colour::Quiet, width: 0.7, fill: Fill::Nothing };
    pen.shape(axes, paint);
    let data = match curve {
        Curve::Step => "M-14 8H-3V-8H13",
        Curve::Ramp => "M-14 8H-6L12 -9",
        Curve::Sine => "M-14 0C-9 -14 -5 -14 0 0S9 14 14 0",
        Curve::Pulse => "M-14 8H-10V-8H-4V8H2V-8H8V8H13",
        Curve::Move => "M-14 8C-3 8 -6 -8 12 -8",
        Curve::Record => "M-14 6L-9 2L-6 5L-1 -6L3 -3L8 -9L13 -7",
        Curve::Saturation => "M-14 8H-7L7 -8H14",
        Curve::DeadZone => "M-14 9L-6 0H6L14 -9",
        Curve::Relay => "M-14 8H5V-8H14M5 -8H-5V8",
        Curve::Quantizer => "M-14 9H-9V4.5H-3V0H3V-4.5H9V-9H14",
        Curve::Backlash => "M-10 9L4 -9H11L-3 9H-14M4 -9L-3 9",
        Curve::RateLimit => "M-12 9L12 -9",
        Curve::Sign => "M-14 8H0M0 -8H14",
        Curve::Table => "M-13 8L-6 3L-1 -4L6 -6L13 -9",
        Curve::Hold => "M-14 8H-8V3H-2V-3H4V-8H13",
        Curve::Modulation => "M-14 2L-9 -11L-4 2L1 -11L6 2L11 -11M-14 10H-11V5H-7V10H-2V5H4V10H9V5H13",
    };
    let width = if curve == Curve::Modulation { 1.1 } else { 1.6 };
    pen.shape(data, Paint { width, ..pen.ink() });
}
