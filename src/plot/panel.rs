//! Panels: two axes, and items on them in data coordinates.

use super::Axis;

/// A colour with a dash pattern that distinguishes it in grey (Okabe & Ito 2008).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Ink {
    /// Blue, solid.
    Blue,
    /// Vermilion, dashed.
    Vermilion,
    /// Green, dash-dot.
    Green,
    /// Reddish purple, dotted.
    Purple,
    /// The truth: thin, black, solid.
    Black,
    /// Lines for orientation: thin, grey, solid.
    Grey,
}

/// The shape of a measured point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Marker {
    /// A small disc, for many points.
    Dot,
    Disc,
    Ring,
    Square,
    Triangle,
    Cross,
}

impl Marker {
    /// A sign like it, to be written before what is said of its points.
    pub fn sign(self) -> &'static str {
        match self {
            Self::Dot | Self::Disc => "●",
            Self::Ring => "○",
            Self::Square => "■",
            Self::Triangle => "▲",
            Self::Cross => "×",
        }
    }
}

/// On which side of its point a text is placed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Side {
    Left,
    Right,
    Above,
    /// Above and to the right of the point.
    UpperRight,
    Centre,
}

/// How the points of a series are drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Kind {
    /// A curve through them.
    Line,
    /// The region between low and high.
    Band,
    /// A marker each, and a bar from low to high.
    Marks(Marker),
    /// A bar each from the axis to y, so wide in units of x.
    Bars(f64),
}

/// An item on a panel, in data coordinates, clipped to the axes.
#[derive(Debug, Clone)]
pub(crate) enum Item {
    /// points x, y, low and high, NaN where a point has none of these; a series without a name is a legend's
    /// marker and not in the CSV
    Series {
        name: String,
        ink: Ink,
        kind: Kind,
        points: Vec<[f64; 4]>,
    },
    /// a region between two values of x
    Shade {
        from: f64,
        to: f64,
    },
    Arrow {
        ink: Ink,
        from: [f64; 2],
        to: [f64; 2],
    },
    Text {
        ink: Ink,
        at: [f64; 2],
        side: Side,
        text: String,
    },
    /// a text of one line or more beside one of these points, wherever there is room
    Label {
        ink: Ink,
        beside: Vec<[f64; 2]>,
        text: String,
    },
}

/// A pair of axes with the items on them.
#[derive(Debug, Clone)]
pub(crate) struct Panel {
    pub heading: String,
    pub x: Axis,
    pub y: Axis,
    pub items: Vec<Item>,
    /// a drawing, without axes
    pub bare: bool,
}

impl Panel {
    /// Empty axes under a heading.
    pub fn new(heading: &str, x: Axis, y: Axis) -> Self {
        Self { heading: heading.into(), x, y, items: Vec::new(), bare: false }
    }

    fn series(
        &mut self,
        name: &str,
        ink: Ink,
        kind: Kind,
        points: impl IntoIterator<Item = [f64; 4]>,
    ) -> &mut Self {
        self.add(Item::Series { name: name.into(), ink, kind, points: points.into_iter().collect() })
    }

    /// A curve through `points`.
    pub fn line(&mut self, name: &str, ink: Ink, points: impl IntoIterator<Item = [f64; 2]>) -> &mut Self {
        self.series(name, ink, Kind::Line, points.into_iter().map(alone))
    }

    /// The curve y = f(x) over the whole axis, through 241 evenly spaced points.
    pub fn curve(&mut self, name: &str, ink: Ink, f: impl Fn(f64) -> f64) -> &mut Self {
        self.curve_between(name, ink, [self.x.low, self.x.high], f)
    }

    /// The curve y = f(x) for x from `low` to `high`.
    pub fn curve_between(
        &mut self,
        name: &str,
        ink: Ink,
        [low, high]: [f64; 2],
        f: impl Fn(f64) -> f64,
    ) -> &mut Self {
        let along = (0..=240).map(|i| self.x.between(low, high, f64::from(i) / 240.0));
        let points: Vec<_> = along.map(|x| [x, f(x)]).filter(|[_, y]| y.is_finite()).collect();
        self.line(name, ink, points)
    }

    /// A horizontal line across the panel.
    pub fn level(&mut self, name: &str, ink: Ink, y: f64) -> &mut Self {
        self.line(name, ink, [[self.x.low, y], [self.x.high, y]])
    }

    /// A vertical line across the panel.
    pub fn upright(&mut self, name: &str, ink: Ink, x: f64) -> &mut Self {
        self.line(name, ink, [[x, self.y.low], [x, self.y.high]])
    }

    /// The region between low and high, given as (x, low, high).
    pub fn band(&mut self, name: &str, ink: Ink, points: impl IntoIterator<Item = [f64; 3]>) -> &mut Self {
        let points = points.into_iter().map(|[x, low, high]| [x, f64::NAN, low, high]);
        self.series(name, ink, Kind::Band, points)
    }

    /// Measured points.
    pub fn marks(
        &mut self,
        name: &str,
        ink: Ink,
        marker: Marker,
        points: impl IntoIterator<Item = [f64; 2]>,
    ) -> &mut Self {
        self.series(name, ink, Kind::Marks(marker), points.into_iter().map(alone))
    }

    /// Measured points with their intervals, given as (x, y, low, high).
    pub fn error_bars(
        &mut self,
        name: &str,
        ink: Ink,
        marker: Marker,
        points: impl IntoIterator<Item = [f64; 4]>,
    ) -> &mut Self {
        self.series(name, ink, Kind::Marks(marker), points)
    }

    /// Bars from the axis up to y, centred on x.
    pub fn bars(
        &mut self,
        name: &str,
        ink: Ink,
        width: f64,
        points: impl IntoIterator<Item = [f64; 2]>,
    ) -> &mut Self {
        self.series(name, ink, Kind::Bars(width), points.into_iter().map(alone))
    }

    /// A shaded region between two values of x.
    pub fn shade(&mut self, from: f64, to: f64) -> &mut Self {
        self.add(Item::Shade { from, to })
    }

    /// An arrow.
    pub fn arrow(&mut self, ink: Ink, from: [f64; 2], to: [f64; 2]) -> &mut Self {
        self.add(Item::Arrow { ink, from, to })
    }

    /// A text beside a point.
    pub fn text(&mut self, ink: Ink, at: [f64; 2], side: Side, text: &str) -> &mut Self {
        self.add(Item::Text { ink, at, side, text: text.into() })
    }

    /// A text beside `at`, where there is room.
    pub fn label(&mut self, ink: Ink, at: [f64; 2], text: &str) -> &mut Self {
        self.add(Item::Label { ink, beside: vec![at], text: text.into() })
    }

    /// Names the line or the marks added last, where there is room beside them.
    pub fn named(&mut self, text: &str) -> &mut Self {
        let Some(Item::Series { ink, kind, points, .. }) = self.items.last() else { return self };
        let points: Vec<_> = points.iter().map(|&[x, y, ..]| [x, y]).collect();
        let beside = if *kind == Kind::Line { self.along(&points) } else { points };
        self.add(Item::Label { ink: *ink, beside, text: text.into() })
    }

    /// Points of a line, fiftieths of the axes apart.
    fn along(&self, points: &[[f64; 2]]) -> Vec<[f64; 2]> {
        let placed: Vec<_> = points.iter().map(|&[x, y]| [self.x.place(x), self.y.place(y)]).collect();
        let mut along = Vec::new();
        for pair in placed.windows(2) {
            let &[from, to] = pair else { continue };
            let step = [to[0] - from[0], to[1] - from[1]];
            let count = (50.0 * step[0].abs().max(step[1].abs())).ceil().clamp(1.0, 1000.0);
            let parts = (0..count as u32).map(|part| f64::from(part) / count);
            along.extend(parts.map(|part| self.spot(from[0] + part * step[0], from[1] + part * step[1])));
        }
        // one a fiftieth will do
        let mut last = [f64::INFINITY; 2];
        along.retain(|&[x, y]| {
            let at = [self.x.place(x), self.y.place(y)];
            let far = (at[0] - last[0]).abs().max((at[1] - last[1]).abs()) >= 0.02;
            if far {
                last = at;
            }
            far
        });
        along
    }

    /// A text beside the point at these fractions of the axes.
    pub fn note(&mut self, ink: Ink, [across, up]: [f64; 2], side: Side, text: &str) -> &mut Self {
        let at = self.spot(across, up);
        self.text(ink, at, side, text)
    }

    /// The point at these fractions of the axes.
    pub fn spot(&self, across: f64, up: f64) -> [f64; 2] {
        [self.x.value(across), self.y.value(up)]
    }

    fn add(&mut self, item: Item) -> &mut Self {
        self.items.push(item);
        self
    }
}

/// A point without an interval.
fn alone([x, y]: [f64; 2]) -> [f64; 4] {
    [x, y, f64::NAN, f64::NAN]
}
