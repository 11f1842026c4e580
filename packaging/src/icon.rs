//! The icon of the FMU: a membrane between two electrodes, thinned by the charge on them.

use anyhow::{Context, Result};
use tiny_skia::{Color, FillRule, Paint, Path, PathBuilder, Pixmap, Rect, Stroke, Transform};

/// Width and height in pixels.
const SIZE: u32 = 128;

const PAPER: [u8; 3] = [255, 255, 255];
const MEMBRANE: [u8; 3] = [230, 159, 0];
const ELECTRODE: [u8; 3] = [0, 114, 178];
const INK: [u8; 3] = [40, 40, 40];

/// Width and height of the icon of a terminal.
const TERMINAL_SIZE: u32 = 32;

/// The icon of a terminal as a PNG file: a square of its colour.
///
/// # Errors
/// If it cannot be drawn or encoded, which would be a mistake here.
pub fn terminal(rgb: [u8; 3]) -> Result<Vec<u8>> {
    let mut canvas =
        Pixmap::new(TERMINAL_SIZE, TERMINAL_SIZE).context("an icon of a terminal has a size")?;
    canvas.fill(colour(INK));
    let inner = TERMINAL_SIZE as f32 - 4.0;
    let square = PathBuilder::from_rect(rectangle(2.0, 2.0, inner, inner)?);
    fill(&mut canvas, rgb, &square);
    canvas.encode_png().context("cannot encode the icon")
}

/// The icon as a PNG file.
///
/// # Errors
/// If it cannot be drawn or encoded, which would be a mistake here.
pub fn png() -> Result<Vec<u8>> {
    let mut canvas = Pixmap::new(SIZE, SIZE).context("an icon has a size")?;
    canvas.fill(colour(PAPER));
    // The undeformed membrane, dashed, and the stretched one with its electrodes.
    let undeformed = PathBuilder::from_rect(rectangle(36.0, 32.0, 56.0, 64.0)?);
    let dashes = Stroke {
        width: 2.0,
        dash: tiny_skia::StrokeDash::new(vec![6.0, 4.0], 0.0),
        ..Stroke::default()
    };
    canvas.stroke_path(
        &undeformed,
        &paint(INK),
        &dashes,
        Transform::identity(),
        None,
    );
    fill(
        &mut canvas,
        MEMBRANE,
        &PathBuilder::from_rect(rectangle(16.0, 50.0, 96.0, 28.0)?),
    );
    for top in [42.0, 78.0] {
        fill(
            &mut canvas,
            ELECTRODE,
            &PathBuilder::from_rect(rectangle(16.0, top, 96.0, 8.0)?),
        );
    }
    // Arrows from the undeformed to the stretched edges.
    for (tip, base) in [(4.0, 14.0), (124.0, 114.0)] {
        let mut arrow = PathBuilder::new();
        arrow.move_to(tip, 64.0);
        arrow.line_to(base, 56.0);
        arrow.line_to(base, 72.0);
        arrow.close();
        fill(
            &mut canvas,
            INK,
            &arrow.finish().context("an arrow has an area")?,
        );
    }
    // The signs of the charge.
    for (left, top, width, height) in [
        (56.0, 20.0, 16.0, 4.0),
        (62.0, 14.0, 4.0, 16.0),
        (56.0, 104.0, 16.0, 4.0),
    ] {
        fill(
            &mut canvas,
            ELECTRODE,
            &PathBuilder::from_rect(rectangle(left, top, width, height)?),
        );
    }
    canvas.encode_png().context("cannot encode the icon")
}

fn rectangle(left: f32, top: f32, width: f32, height: f32) -> Result<Rect> {
    Rect::from_xywh(left, top, width, height).context("a rectangle has an area")
}

fn fill(canvas: &mut Pixmap, rgb: [u8; 3], path: &Path) {
    canvas.fill_path(
        path,
        &paint(rgb),
        FillRule::Winding,
        Transform::identity(),
        None,
    );
}

fn paint(rgb: [u8; 3]) -> Paint<'static> {
    let mut paint = Paint::default();
    paint.set_color(colour(rgb));
    paint
}

fn colour([red, green, blue]: [u8; 3]) -> Color {
    Color::from_rgba8(red, green, blue, 255)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_icon_is_a_png_and_always_the_same() -> Result<()> {
        let icon = png()?;
        assert!(icon.starts_with(b"\x89PNG\r\n\x1a\n"));
        assert_eq!(icon, png()?);
        Ok(())
    }
}
