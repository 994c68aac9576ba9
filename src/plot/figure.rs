//! Figures as they are shown and saved.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

#[cfg(feature = "png")]
use resvg::usvg;
#[cfg(all(feature = "pdf", not(feature = "png")))]
use svg2pdf::usvg;

use super::{Edition, Plot, document, render};
use crate::error::{Error, Result};
use crate::numbers::typeset;

/// A drawn figure: the picture, and the numbers in it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Figure {
    pub(super) name: String,
    pub(super) title: String,
    pub(super) description: String,
    pub(super) edition: Edition,
    pub(super) svg: String,
    pub(super) csv: String,
}

impl Plot {
    /// Draws it, under a title that says in one line what it shows, with a description for readers who cannot
    /// see it. In the student edition neither must tell the answer.
    pub fn draw(&self, title: impl Into<String>, description: impl Into<String>) -> Result<Figure> {
        let (title, description) = (title.into(), description.into());
        let suffix = match self.edition {
            Edition::Student => "_student",
            Edition::Solution => "",
        };
        let name = format!("{}{suffix}", self.name);
        let mut axes = self.panels.iter().flat_map(|panel| [&panel.x, &panel.y]);
        if let Some(axis) = axes.find(|axis| !axis.can_be_drawn()) {
            let [low, high] = [axis.low, axis.high].map(|end| typeset(end, 3));
            let reason = format!("no axis can be drawn from {low} to {high} ({})", axis.name);
            return Err(Error::Draft { what: name, reason });
        }
        let body = render::body(self).map_err(|reason| Error::Draft { what: name.clone(), reason })?;
        let svg = document::of_plot(&name, [self.width_mm, self.height_mm], [&title, &description], &body);
        Ok(Figure { svg, csv: self.csv(), title, description, edition: self.edition, name })
    }
}

impl Figure {
    /// The file name without extension: the question's number and a word, and `_student` in that edition.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The title: what the figure shows, in one line.
    pub fn title(&self) -> &str {
        &self.title
    }

    /// The description for readers who cannot see it.
    pub(crate) fn description(&self) -> &str {
        &self.description
    }

    /// For whom it was drawn.
    pub fn edition(&self) -> Edition {
        self.edition
    }

    /// The picture: an SVG document with a title, a description and sizes in mm.
    pub fn svg(&self) -> &str {
        &self.svg
    }

    /// The numbers drawn, to six significant digits, one row per point: `panel,series,x,y,low,high`.
    pub fn csv(&self) -> &str {
        &self.csv
    }

    /// Writes `name.svg` and `name.csv` into `folder`, which is created if necessary (with the features `png`
    /// and `pdf` those formats, too). Each file is written completely or not at all. Returns the paths, the
    /// SVG's first.
    ///
    /// # Errors
    /// If the folder or a file cannot be written.
    pub fn save(&self, folder: &Path) -> Result<Vec<PathBuf>> {
        let mut files = vec![("svg", self.svg.clone().into_bytes()), ("csv", self.csv.clone().into_bytes())];
        files.retain(|(_, bytes)| !bytes.is_empty());
        #[cfg(feature = "png")]
        files.push(("png", self.png(300.0)?));
        #[cfg(feature = "pdf")]
        files.push(("pdf", self.pdf()?));
        files
            .into_iter()
            .map(|(ending, bytes)| {
                let path = folder.join(format!("{}.{ending}", self.name));
                write_whole(&path, &bytes)?;
                Ok(path)
            })
            .collect()
    }

    /// The picture as PNG, at this many dots per inch, on white.
    ///
    /// # Errors
    /// If the picture cannot be drawn at this size.
    #[cfg(feature = "png")]
    pub fn png(&self, dots_per_inch: f32) -> Result<Vec<u8>> {
        use resvg::tiny_skia;
        let tree = self.tree()?;
        let scale = dots_per_inch / 96.0;
        let size = tree.size().to_int_size().scale_by(scale);
        let mut pixels = size
            .and_then(|size| tiny_skia::Pixmap::new(size.width(), size.height()))
            .ok_or_else(|| self.refused("it has no size"))?;
        pixels.fill(tiny_skia::Color::WHITE);
        resvg::render(&tree, tiny_skia::Transform::from_scale(scale, scale), &mut pixels.as_mut());
        pixels.encode_png().map_err(|error| self.refused(error))
    }

    /// The picture as a PDF page of the same size. Its bytes may differ between runs, its content does not.
    ///
    /// # Errors
    /// If the picture cannot be converted.
    #[cfg(feature = "pdf")]
    pub fn pdf(&self) -> Result<Vec<u8>> {
        let tree = self.tree()?;
        svg2pdf::to_pdf(&tree, Default::default(), Default::default()).map_err(|error| self.refused(error))
    }

    /// The picture, read with the fonts used for its layout, so that no system font is needed.
    #[cfg(any(feature = "png", feature = "pdf"))]
    fn tree(&self) -> Result<usvg::Tree> {
        let mut options = usvg::Options::default();
        let fonts = options.fontdb_mut();
        fonts.load_font_data(dejavu::sans::regular().to_vec());
        fonts.load_font_data(dejavu::sans::bold().to_vec());
        fonts.set_sans_serif_family("DejaVu Sans");
        usvg::Tree::from_str(&self.svg, &options).map_err(|error| self.refused(error))
    }

    #[cfg(any(feature = "png", feature = "pdf"))]
    fn refused(&self, reason: impl ToString) -> Error {
        Error::Draft { what: self.name.clone(), reason: reason.to_string() }
    }
}

/// Writes a file completely or not at all, and creates its folder if necessary. If several threads or
/// processes write the same file at once, the last complete one stays.
pub(crate) fn write_whole(path: &Path, bytes: &[u8]) -> Result<()> {
    let failed =
        |error: std::io::Error| Error::Write { path: path.display().to_string(), reason: error.to_string() };
    if let Some(folder) = path.parent() {
        fs::create_dir_all(folder).map_err(failed)?;
    }
    // a temporary name that no other writer uses
    static COUNT: AtomicU64 = AtomicU64::new(0);
    let mut part = path.as_os_str().to_owned();
    part.push(format!(".{}-{}.part", std::process::id(), COUNT.fetch_add(1, Ordering::Relaxed)));
    fs::write(&part, bytes).and_then(|()| fs::rename(&part, path)).map_err(|error| {
        // remove the temporary file; if that fails, too, report the first error
        let _ = fs::remove_file(&part);
        failed(error)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_appears_whole_or_not_at_all() {
        let folder = std::env::temp_dir().join(format!("unbiased-{}", std::process::id()));
        let path = folder.join("deep").join("file.txt");
        write_whole(&path, b"whole").unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"whole");
        // a folder where the file should be
        let taken = folder.join("taken");
        fs::create_dir_all(taken.join("inside")).unwrap();
        assert!(matches!(write_whole(&taken, b"x"), Err(Error::Write { .. })));
        let mut left: Vec<_> =
            fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().file_name()).collect();
        left.sort();
        assert_eq!(left, ["deep", "taken"]);
        fs::remove_dir_all(&folder).unwrap();
    }

    #[test]
    fn writers_of_one_file_do_not_disturb_each_other() {
        let folder = std::env::temp_dir().join(format!("unbiased-writers-{}", std::process::id()));
        let path = folder.join("file.txt");
        let write = |byte| (0..50).try_for_each(|_| write_whole(&path, &[byte; 10_000]));
        std::thread::scope(|scope| {
            let writers: Vec<_> = (0..8).map(|byte| scope.spawn(move || write(byte))).collect();
            assert!(writers.into_iter().all(|writer| writer.join().unwrap().is_ok()));
        });
        let whole = fs::read(&path).unwrap();
        assert!(whole.len() == 10_000 && whole.iter().all(|byte| *byte == whole[0]));
        assert_eq!(fs::read_dir(&folder).unwrap().count(), 1);
        // a file where the folder should be
        let refused = write_whole(&path.join("file.txt"), b"x").unwrap_err().to_string();
        assert!(refused.contains("could not be written"), "{refused}");
        fs::remove_dir_all(&folder).unwrap();
    }
}
