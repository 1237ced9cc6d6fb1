//! A drawing of lines, text and rendered pictures, to SVG or PNG.

use base64::{Engine, engine::general_purpose::STANDARD};
use kuva::{
    backend::{png::PngBackend, svg::SvgBackend},
    render::{
        color::Color,
        render::{PathData, Primitive, Scene, TextAnchor},
    },
};

use crate::picture::{Format, Picture, PictureError, Preview, encode, to_srgb};

/// Device pixels a unit in a PNG; rendered pictures have as many.
pub(super) const SCALE: u32 = 2;

/// An sRGB colour of lines and text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Ink(pub u8, pub u8, pub u8);

impl Ink {
    pub(super) const TEXT: Self = Self(40, 44, 52);
    pub(super) const FAINT: Self = Self(110, 116, 128);
    pub(super) const GRID: Self = Self(222, 226, 232);

    fn color(self) -> Color {
        Color::Rgb(self.0, self.1, self.2)
    }
}

/// Where a text stands against its point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Anchor {
    Start,
    Middle,
}

/// A page: x grows to the right, y downwards, in units of which a PNG has two pixels each.
#[derive(Debug)]
pub struct Drawing {
    scene: Scene,
    pictures: Vec<Placed>,
}

#[derive(Debug)]
struct Placed {
    picture: Picture,
    x: f64,
    y: f64,
}

impl Drawing {
    /// An empty white page.
    pub(super) fn new(width: f64, height: f64) -> Self {
        let mut scene = Scene::new(width, height);
        scene.font_family = Some("DejaVu Sans, Verdana, sans-serif".into());
        Self { scene, pictures: Vec::new() }
    }

    /// Text on a baseline at `y`.
    pub(super) fn text(&mut self, (x, y): (f64, f64), size: u32, anchor: Anchor, ink: Ink, text: &str) {
        let anchor = match anchor {
            Anchor::Start => TextAnchor::Start,
            Anchor::Middle => TextAnchor::Middle,
        };
        self.scene.add(Primitive::Text {
            x,
            y,
            content: text.into(),
            size,
            anchor,
            rotate: None,
            bold: false,
            color: Some(ink.color()),
        });
    }

    /// A polyline; `dashes` as in SVG.
    pub(super) fn line(&mut self, points: Vec<(f64, f64)>, ink: Ink, width: f64, dashes: Option<&str>) {
        self.scene.add(Primitive::PolyLine {
            points,
            stroke: ink.color(),
            stroke_width: width,
            stroke_dasharray: dashes.map(Into::into),
        });
    }

    /// A filled polygon without an outline.
    pub(super) fn area(&mut self, points: &[(f64, f64)], ink: Ink, opacity: f64) {
        let corner =
            |(i, (x, y)): (usize, &(f64, f64))| format!("{} {x:.2} {y:.2} ", if i == 0 { 'M' } else { 'L' });
        let outline: String = points.iter().enumerate().map(corner).collect();
        self.scene.add(Primitive::Path(Box::new(PathData {
            d: outline + "Z",
            fill: Some(ink.color()),
            stroke: Color::None,
            stroke_width: 0.0,
            opacity: Some(opacity),
            stroke_dasharray: None,
        })));
    }

    /// A dot.
    pub(super) fn dot(&mut self, (cx, cy): (f64, f64), r: f64, ink: Ink) {
        self.scene.add(Primitive::Circle {
            cx,
            cy,
            r,
            fill: ink.color(),
            fill_opacity: None,
            stroke: None,
            stroke_width: None,
        });
    }

    /// A chart of the plotting library, its corner at (x, y).
    pub(super) fn chart(&mut self, (x, y): (f64, f64), chart: Scene) {
        let transform = Some(format!("translate({x},{y})"));
        self.scene.add(Primitive::GroupStart { transform, title: None, extra_attrs: None });
        self.scene.elements.extend(chart.elements);
        self.scene.add(Primitive::GroupEnd);
    }

    /// A rendered picture, its corner at (x, y), above all lines.
    pub(super) fn picture(&mut self, (x, y): (f64, f64), picture: Picture) {
        self.pictures.push(Placed { picture, x, y });
    }

    /// The drawing as SVG; pictures are embedded as PNG.
    ///
    /// # Errors
    /// [`PictureError`] if a picture has no `R G B`.
    pub fn svg(&self) -> Result<String, PictureError> {
        const END: &str = "</svg>";
        let mut svg = SvgBackend::new().render_scene(&self.scene);
        let rest = svg.rfind(END).map_or(String::new(), |end| svg.split_off(end));
        for Placed { picture, x, y } in &self.pictures {
            let png = STANDARD.encode(encode(picture, Format::Png, Preview::default())?);
            let (width, height) = (picture.width / SCALE, picture.height / SCALE);
            svg += &format!(
                "<image x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\" \
                 href=\"data:image/png;base64,{png}\"/>"
            );
        }
        Ok(svg + &rest)
    }

    /// The drawing as the bytes of a PNG.
    ///
    /// # Errors
    /// A sentence, if a picture has no `R G B` or the page is too large.
    pub fn png(self) -> Result<Vec<u8>, String> {
        let mut scene = self.scene;
        let side = 1.0 / f64::from(SCALE);
        for Placed { picture, x, y } in &self.pictures {
            let pixels = to_srgb(picture, Preview::default())?;
            let (count, width) = (pixels.len(), picture.width as usize);
            scene.add(Primitive::RectBatch {
                x: (0..count).map(|i| x + (i % width) as f64 * side).collect(),
                y: (0..count).map(|i| y + (i / width) as f64 * side).collect(),
                w: vec![side; count],
                h: vec![side; count],
                fills: pixels.into_iter().map(|[r, g, b]| Color::Rgb(r, g, b)).collect(),
            });
        }
        PngBackend::new().with_scale(SCALE as f32).render_scene(&scene)
    }
}
