use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg;

use crate::error::PictureError;
use crate::outline::outlined;

/// Most dots of a picture, which then needs 256 MiB.
const DOTS: u64 = 64 << 20;

/// A drawing in SVG as a picture in PNG, with `scale` dots for each unit of length.
///
/// Texts are drawn with the font of this crate. They and the elements around them may say `font-size` (a number, with
/// or without `px`), `text-anchor` and `font-weight`, all as attributes; parts with places of their own (`tspan`) are
/// joined to one text.
///
/// # Errors
///
/// [`PictureError`] where the text is no SVG or the picture would need too much memory.
pub fn png(svg: &str, scale: f64) -> Result<Vec<u8>, PictureError> {
    let text = outlined(svg)?;
    let tree = usvg::Tree::from_str(&text, &usvg::Options::default())
        .map_err(|error| PictureError::NotSvg(error.to_string()))?;
    let dots = |length: f32| (f64::from(length) * scale).ceil().max(1.0) as u64;
    let (width, height) = (dots(tree.size().width()), dots(tree.size().height()));
    let too_large = PictureError::TooLarge { width, height };
    if width.saturating_mul(height) > DOTS {
        return Err(too_large);
    }
    let (Ok(across), Ok(down)) = (u32::try_from(width), u32::try_from(height)) else { return Err(too_large) };
    let mut pixmap = Pixmap::new(across, down).ok_or(too_large)?;
    resvg::render(&tree, Transform::from_scale(scale as f32, scale as f32), &mut pixmap.as_mut());
    pixmap.encode_png().map_err(|error| PictureError::Packing(error.to_string()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn dots(svg: &str, scale: f64) -> Pixmap {
        Pixmap::decode_png(&png(svg, scale).unwrap()).unwrap()
    }

    #[test]
    fn a_rectangle_has_its_colour_and_the_scale_its_size() {
        let svg = r##"<svg xmlns="http://www.w3.org/2000/svg" width="4" height="2">
            <rect width="2" height="2" fill="#105A53"/></svg>"##;
        let picture = dots(svg, 2.0);
        assert_eq!((picture.width(), picture.height()), (8, 4));
        let colour = picture.pixel(1, 1).unwrap();
        assert_eq!((colour.red(), colour.green(), colour.blue(), colour.alpha()), (0x10, 0x5A, 0x53, 255));
        assert_eq!(picture.pixel(6, 1).unwrap().alpha(), 0);
    }

    #[test]
    fn texts_leave_ink_where_they_stand() {
        let svg = r#"<svg xmlns="http://www.w3.org/2000/svg" width="40" height="20">
            <text x="39" y="16" font-size="14" text-anchor="end">l</text></svg>"#;
        let picture = dots(svg, 1.0);
        let inked = |x: std::ops::Range<u32>| {
            x.flat_map(|x| (0..20).map(move |y| (x, y)))
                .any(|(x, y)| picture.pixel(x, y).unwrap().alpha() > 100)
        };
        assert!(inked(33..40) && !inked(0..33));
    }

    #[test]
    fn pictures_beyond_measure_are_refused() {
        let svg = r#"<svg xmlns="http://www.w3.org/2000/svg" width="4000" height="4000"/>"#;
        let error = png(svg, 100.0).unwrap_err();
        assert_eq!(
            error.to_string(),
            "a picture of 400000 x 400000 dots is too large; choose a smaller size or scale"
        );
        assert!(png("no svg", 1.0).is_err());
        assert!(png(svg, f64::INFINITY).is_err());
    }
}
