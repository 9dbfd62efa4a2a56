//! Figures as PNG, where this program was built with the feature `png` and the machine has a font.

#[cfg(not(feature = "png"))]
use phihat_paper::PaintError;

#[cfg(feature = "png")]
pub(crate) use painter::Painter;

#[cfg(feature = "png")]
mod painter {
    use std::sync::Arc;

    use phihat_paper::PaintError;
    use resvg::tiny_skia::{Color, Pixmap, Transform};
    use resvg::usvg::{Options, Tree, fontdb};

    /// Pixels per centimetre on paper: 254 dpi.
    const PIXELS_PER_CM: f32 = 100.0;
    /// Pixels of an SVG per centimetre.
    const CSS_PIXELS_PER_CM: f32 = 96.0 / 2.54;

    /// The machine's fonts.
    #[derive(Debug)]
    pub(crate) struct Painter {
        fonts: Arc<fontdb::Database>,
        family: String,
    }

    impl Painter {
        /// With the machine's fonts.
        pub(crate) fn new() -> Result<Self, PaintError> {
            let mut fonts = fontdb::Database::new();
            fonts.load_system_fonts();
            Self::with(fonts)
        }

        /// Looks for a font without serifs, or any.
        fn with(mut fonts: fontdb::Database) -> Result<Self, PaintError> {
            let has =
                |family: &str| fonts.faces().any(|f| f.families.iter().any(|n| n.0 == family));
            let known = ["DejaVu Sans", "Arial", "Liberation Sans", "Noto Sans", "Helvetica"];
            let first = || fonts.faces().find_map(|f| f.families.first().map(|n| n.0.clone()));
            let family = known.into_iter().find(|name| has(name)).map(str::to_owned).or_else(first);
            let family =
                family.ok_or("no PNG: this machine has no font; the SVG files are complete")?;
            fonts.set_sans_serif_family(&family);
            Ok(Self { fonts: Arc::new(fonts), family })
        }

        /// An SVG as PNG.
        pub(crate) fn paint(&self, svg: &str) -> Result<Vec<u8>, PaintError> {
            let options = Options {
                fontdb: Arc::clone(&self.fonts),
                font_family: self.family.clone(),
                ..Options::default()
            };
            let tree = Tree::from_str(svg, &options)
                .map_err(|e| PaintError::from(format!("no PNG: {e}")))?;
            let scale = PIXELS_PER_CM / CSS_PIXELS_PER_CM;
            let size = tree.size().scale_by(scale);
            let size = size.ok_or("no PNG: the figure has no size")?.to_int_size();
            let mut pixels = Pixmap::new(size.width(), size.height())
                .ok_or("no PNG: the figure is too large")?;
            pixels.fill(Color::WHITE);
            resvg::render(&tree, Transform::from_scale(scale, scale), &mut pixels.as_mut());
            pixels.encode_png().map_err(|e| PaintError::from(format!("no PNG: {e}")))
        }
    }

    #[cfg(test)]
    #[allow(clippy::unwrap_used, reason = "in a test a panic is the report")]
    mod tests {
        use super::{Painter, fontdb};
        use resvg::tiny_skia::Pixmap;

        /// Two by one centimetres, the right half blue.
        const HALVES: &str = r##"<svg xmlns="http://www.w3.org/2000/svg" width="2cm" height="1cm" viewBox="0 0 200 100">
            <rect x="100" y="0" width="100" height="100" fill="#0072B2"/>WORDS</svg>"##;

        fn pixels(painter: &Painter, words: &str) -> Pixmap {
            Pixmap::decode_png(&painter.paint(&HALVES.replace("WORDS", words)).unwrap()).unwrap()
        }

        fn bare() -> Painter {
            Painter { fonts: fontdb::Database::new().into(), family: String::new() }
        }

        #[test]
        fn a_centimetre_is_a_hundred_pixels_and_colours_are_where_they_belong() {
            let plain = pixels(&bare(), "");
            assert_eq!((plain.width(), plain.height()), (200, 100));
            let at = |x, y| plain.pixel(x, y).map(|p| (p.red(), p.green(), p.blue(), p.alpha()));
            assert_eq!(at(50, 50), Some((255, 255, 255, 255)));
            assert_eq!(at(150, 50), Some((0, 114, 178, 255)));
        }

        #[test]
        fn words_are_written_or_there_is_one_line_of_why() {
            let words =
                r#"<text x="10" y="60" font-family="sans-serif" font-size="40">φ̂ mm</text>"#;
            let dark = |map: &Pixmap| {
                map.pixels().iter().filter(|p| p.red() < 64 && p.blue() < 64).count()
            };
            match Painter::new() {
                Ok(painter) => assert!(dark(&pixels(&painter, words)) > 200, "no text"),
                Err(why) => assert!(why.to_string().contains("no font"), "{why}"),
            }
            let none = Painter::with(fontdb::Database::new()).unwrap_err();
            assert_eq!(
                none.to_string(),
                "no PNG: this machine has no font; the SVG files are complete"
            );
            assert!(bare().paint("<svg").unwrap_err().to_string().starts_with("no PNG: "));
        }
    }
}

/// Nothing that could paint.
#[cfg(not(feature = "png"))]
#[derive(Debug)]
pub(crate) struct Painter;

#[cfg(not(feature = "png"))]
impl Painter {
    pub(crate) fn new() -> Result<Self, PaintError> {
        Err("no PNG: build with `--features png` for them; the SVG files are complete".into())
    }

    #[allow(clippy::unused_self, reason = "the same call with and without the feature")]
    pub(crate) fn paint(&self, _svg: &str) -> Result<Vec<u8>, PaintError> {
        Err("".into())
    }
}
