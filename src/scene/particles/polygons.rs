//! Polygons between the points of a file, for those formats that also hold surfaces.

use super::error::{ReadError, counted};
use super::values::Values;

/// Polygons, by the numbers of their points.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Polygons {
    /// The points of all polygons, one after the other.
    pub corners: Vec<u32>,
    /// Where each polygon ends in `corners`.
    pub ends: Vec<usize>,
    /// Cells that are no polygons: lines, points, solids.
    pub others: usize,
}

/// What a cell is made of, by its points.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cell {
    Polygon,
    /// Triangles that share edges, every second of them turned over.
    Strip,
    /// A rectangle with its points row by row.
    Pixel,
    /// Something that is no surface.
    Other,
}

impl Polygons {
    /// Adds a cell.
    pub fn push(&mut self, cell: Cell, points: &[u32]) {
        match (cell, points) {
            (Cell::Polygon, points) => self.polygon(points.iter().copied()),
            (Cell::Pixel, [a, b, c, d]) => self.polygon([*a, *b, *d, *c]),
            (Cell::Strip, points) => {
                for (at, t) in points.windows(3).enumerate() {
                    self.polygon(if at % 2 == 0 { [t[0], t[1], t[2]] } else { [t[0], t[2], t[1]] });
                }
            }
            _ => self.others += 1,
        }
    }

    fn polygon(&mut self, points: impl IntoIterator<Item = u32>) {
        self.corners.extend(points);
        self.ends.push(self.corners.len());
    }

    /// The points of each polygon.
    pub fn iter(&self) -> impl Iterator<Item = &[u32]> {
        let starts = std::iter::once(0).chain(self.ends.iter().copied());
        starts.zip(&self.ends).map(|(start, end)| self.corners.get(start..*end).unwrap_or_default())
    }
}

/// Numbers of a file as those of `count` points. `what` ends at the `ends`, for messages.
pub fn indices(values: &Values, count: usize, what: &str, ends: &[usize]) -> Result<Vec<u32>, ReadError> {
    let within = |number: i32| u32::try_from(number).ok().filter(|index| (*index as usize) < count);
    let numbers = values.to_i32().into_iter().enumerate();
    numbers
        .map(|(at, number)| {
            within(number).ok_or_else(|| {
                let of = ends.partition_point(|end| *end <= at);
                let corner = at - of.checked_sub(1).and_then(|before| ends.get(before)).unwrap_or(&0);
                let has = counted(count, "point");
                ReadError::new(format!("{what} {of}, corner {corner}: it is point {number}, of {has}"))
            })
        })
        .collect()
}
