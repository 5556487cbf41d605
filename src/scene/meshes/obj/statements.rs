//! The statements of an OBJ file, a line each.

use std::borrow::Cow;
use std::collections::HashMap;

use crate::scene::meshes::report::{Report, counted, shown};

/// What an OBJ file says, its indices resolved and within their lists.
#[derive(Debug, Default)]
pub struct Statements {
    pub positions: Vec<[f32; 3]>,
    /// For each position, if any has one; sRGB.
    pub colors: Vec<[f32; 3]>,
    pub uvs: Vec<[f32; 2]>,
    pub normals: Vec<[f32; 3]>,
    pub corners: Vec<Corner>,
    pub faces: Vec<Face>,
    /// Names that `usemtl` gave, each once, with the line that first did.
    pub materials: Vec<(usize, String)>,
}

/// A corner of a face, by the numbers of its parts.
#[derive(Clone, Copy, Debug)]
pub struct Corner {
    pub position: u32,
    pub uv: Option<u32>,
    pub normal: Option<u32>,
}

#[derive(Clone, Copy, Debug)]
pub struct Face {
    /// Of its first corner; it has those up to the next face's.
    pub start: usize,
    pub count: usize,
    pub line: usize,
    /// Which of the names; absent: none was given.
    pub material: Option<usize>,
    /// Absent: it is flat.
    pub smoothing: Option<u32>,
}

/// Lines with their numbers, those that end with a backslash joined to the next.
pub fn lines(bytes: &[u8]) -> impl Iterator<Item = (usize, Cow<'_, str>)> {
    let mut rest = bytes.split(|byte| *byte == b'\n').enumerate();
    std::iter::from_fn(move || {
        let (number, first) = rest.next()?;
        let mut line = Cow::Borrowed(first.strip_suffix(b"\r").unwrap_or(first));
        while line.ends_with(b"\\") {
            let Some((_, next)) = rest.next() else { break };
            let whole = line.to_mut();
            whole.pop();
            whole.push(b' ');
            whole.extend(next.strip_suffix(b"\r").unwrap_or(next));
        }
        let text = match line {
            Cow::Borrowed(line) => String::from_utf8_lossy(line),
            Cow::Owned(line) => Cow::Owned(String::from_utf8_lossy(&line).into_owned()),
        };
        Some((number + 1, text))
    })
}

/// A line without its comment: its keyword and what follows.
pub fn split(line: &str) -> Option<(&str, &str)> {
    let line = line.split('#').next().unwrap_or_default().trim();
    let (keyword, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
    (!keyword.is_empty()).then_some((keyword, rest.trim_start()))
}

/// What stands behind `mtllib`, with the number of its line.
pub fn material_files(bytes: &[u8]) -> Vec<(usize, String)> {
    let found = lines(bytes).filter_map(|(number, line)| {
        let (keyword, rest) = split(&line)?;
        (keyword == "mtllib" && !rest.is_empty()).then(|| (number, rest.replace('\\', "/")))
    });
    found.collect()
}

/// The numbers of a line.
pub fn numbers(text: &str, place: &str, report: &mut Report) -> Option<Vec<f32>> {
    let mut numbers = Vec::with_capacity(4);
    for word in text.split_whitespace() {
        match word.parse::<f32>() {
            Ok(number) if number.is_finite() => numbers.push(number),
            _ => {
                report.error(place, format!("expected a number, found {}", shown(word)));
                return None;
            }
        }
    }
    Some(numbers)
}

struct Reader<'a> {
    found: Statements,
    by_name: HashMap<String, usize>,
    material: Option<usize>,
    smoothing: Option<u32>,
    has_smoothing: bool,
    skipped: Skipped,
    report: &'a mut Report,
}

/// What is read over, with the first line of each.
#[derive(Default)]
struct Skipped {
    lines: Option<usize>,
    curves: Option<usize>,
    unknown: Vec<String>,
}

impl Statements {
    pub fn read(bytes: &[u8], report: &mut Report) -> Option<Self> {
        let mut reader = Reader {
            found: Self::default(),
            by_name: HashMap::new(),
            material: None,
            smoothing: None,
            has_smoothing: false,
            skipped: Skipped::default(),
            report,
        };
        for (number, line) in lines(bytes) {
            if let Some((keyword, rest)) = split(&line) {
                reader.statement(number, keyword, rest);
            }
        }
        reader.finish()
    }
}

impl Reader<'_> {
    fn statement(&mut self, number: usize, keyword: &str, rest: &str) {
        match keyword {
            "v" => self.position(number, rest),
            "vt" => {
                // A third number is of volumes; the second may be missing.
                if let Some([u, v]) = self.row(number, rest, 1) {
                    self.found.uvs.push([u, v]);
                }
            }
            "vn" => {
                if let Some(normal) = self.row(number, rest, 3) {
                    self.found.normals.push(normal);
                }
            }
            "f" | "fo" => self.face(number, rest),
            "usemtl" => self.material = (!rest.is_empty()).then(|| self.named(number, rest.trim_end())),
            "s" => {
                self.has_smoothing = true;
                self.smoothing = rest.split_whitespace().next().and_then(|word| word.parse().ok()).filter(|g| *g != 0);
            }
            "l" | "p" => _ = self.skipped.lines.get_or_insert(number),
            "vp" | "cstype" | "deg" | "bmat" | "step" | "curv" | "curv2" | "surf" | "parm" | "trim" | "hole"
            | "scrv" | "sp" | "end" | "con" | "bsp" | "bzp" | "cdc" | "cdp" | "res" => {
                _ = self.skipped.curves.get_or_insert(number);
            }
            "o" | "g" | "mtllib" | "mg" | "bevel" | "c_interp" | "d_interp" | "lod" | "shadow_obj" | "trace_obj"
            | "ctech" | "stech" | "maplib" | "usemap" | "call" | "csh" => {}
            _ => {
                if self.skipped.unknown.len() < 3 && !self.skipped.unknown.iter().any(|k| k == keyword) {
                    self.skipped.unknown.push(keyword.to_owned());
                    self.report.warn(format!("line {number}"), format!("{} is no statement of OBJ", shown(keyword)));
                }
            }
        }
    }

    /// The first `N` numbers of a line that has at least `least`; the others are 0.
    fn row<const N: usize>(&mut self, number: usize, rest: &str, least: usize) -> Option<[f32; N]> {
        let place = format!("line {number}");
        let numbers = numbers(rest, &place, self.report)?;
        if numbers.len() < least {
            let expected = counted(least, "number", "numbers");
            self.report.error(place, format!("expected {expected}, found {}", numbers.len()));
            return None;
        }
        Some(std::array::from_fn(|i| numbers.get(i).copied().unwrap_or(0.0)))
    }

    /// Three numbers, one that is of no account, and perhaps a colour.
    fn position(&mut self, number: usize, rest: &str) {
        let Some([x, y, z, a, b, c, d]) = self.row(number, rest, 3) else {
            // Faces must not mean other vertices than they say; the error stops the model anyway.
            return self.found.positions.push([0.0; 3]);
        };
        let color = match rest.split_whitespace().count() {
            6 => Some([a, b, c]),
            7.. => Some([b, c, d]),
            _ => None,
        };
        if let Some(color) = color {
            self.found.colors.resize(self.found.positions.len(), [1.0; 3]);
            self.found.colors.push(color);
        }
        self.found.positions.push([x, y, z]);
    }

    fn named(&mut self, number: usize, name: &str) -> usize {
        if let Some(known) = self.by_name.get(name) {
            return *known;
        }
        self.found.materials.push((number, name.to_owned()));
        self.by_name.insert(name.to_owned(), self.found.materials.len() - 1);
        self.found.materials.len() - 1
    }

    fn face(&mut self, number: usize, rest: &str) {
        let start = self.found.corners.len();
        for word in rest.split_whitespace() {
            match self.corner(word) {
                Ok(corner) => self.found.corners.push(corner),
                Err(message) => {
                    self.report.error(format!("line {number}"), message);
                    return self.found.corners.truncate(start);
                }
            }
        }
        let count = self.found.corners.len() - start;
        if count < 3 {
            let has = counted(count, "corner", "corners");
            self.report.warn(format!("line {number}"), format!("a face of {has} is left out"));
            return self.found.corners.truncate(start);
        }
        let (material, smoothing) = (self.material, self.smoothing);
        self.found.faces.push(Face { start, count, line: number, material, smoothing });
    }

    /// `position`, `position/uv`, `position//normal` or `position/uv/normal`.
    fn corner(&self, word: &str) -> Result<Corner, String> {
        let mut parts = word.split('/');
        let mut part = |what: &str, count: usize| -> Result<Option<u32>, String> {
            match parts.next() {
                None | Some("") => Ok(None),
                Some(text) => index(text, count, what, word).map(Some),
            }
        };
        let position = part("vertex", self.found.positions.len())?;
        let uv = part("texture coordinate", self.found.uvs.len())?;
        let normal = part("normal", self.found.normals.len())?;
        match position {
            Some(position) if parts.next().is_none() => Ok(Corner { position, uv, normal }),
            _ => Err(format!("{} is no corner of a face; expected vertex/texture/normal", shown(word))),
        }
    }

    fn finish(self) -> Option<Statements> {
        let Self { mut found, skipped, has_smoothing, report, .. } = self;
        if !found.colors.is_empty() {
            found.colors.resize(found.positions.len(), [1.0; 3]);
        }
        if !has_smoothing {
            found.faces.iter_mut().for_each(|face| face.smoothing = Some(1));
        }
        for (first, what) in [(skipped.lines, "lines and points"), (skipped.curves, "curves and surfaces")] {
            if let Some(number) = first {
                report.warn(format!("line {number}"), format!("{what} are not read"));
            }
        }
        if found.positions.is_empty() && !skipped.unknown.is_empty() {
            report.error("", "this is no OBJ: it has no vertices");
        }
        within(&found, report);
        (!report.has_errors()).then_some(found)
    }
}

/// An index from 0. Those of a file count from 1, or backwards from the last one yet.
fn index(text: &str, count: usize, what: &str, word: &str) -> Result<u32, String> {
    let Ok(number) = text.parse::<i64>() else {
        return Err(format!("{} in {} is no index", shown(text), shown(word)));
    };
    let from_0 = if number < 0 { count as i64 + number } else { number - 1 };
    u32::try_from(from_0).map_err(|_| match number {
        0 => format!("{what} 0 in {}: indices count from 1", shown(word)),
        _ => format!("{what} {number} in {}, but there are {count}", shown(word)),
    })
}

/// Reports indices beyond the lists, which may be filled after the faces that use them.
fn within(found: &Statements, report: &mut Report) {
    for face in &found.faces {
        for corner in found.corners.get(face.start..face.start + face.count).unwrap_or_default() {
            let parts = [
                (Some(corner.position), found.positions.len(), "vertex"),
                (corner.uv, found.uvs.len(), "texture coordinate"),
                (corner.normal, found.normals.len(), "normal"),
            ];
            let beyond =
                parts.into_iter().find(|(index, count, _)| index.is_some_and(|index| index as usize >= *count));
            if let Some((Some(index), count, what)) = beyond {
                let message = format!("{what} {}, but there are {count}", u64::from(index) + 1);
                report.error(format!("line {}", face.line), message);
                break;
            }
        }
    }
}
