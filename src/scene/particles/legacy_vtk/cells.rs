//! Cells of legacy VTK, where surfaces are asked for: in the form of version 4, counts and indices
//! in one list, and of version 5, offsets and connectivity.

use super::{Kind, ReadError, Reader, Type, Values, shown};
use crate::scene::particles::polygons::{Cell, Polygons, indices};

/// Cells as a file has them, not yet held against its points.
#[derive(Debug, Default)]
pub(super) struct Cells {
    blocks: Vec<Block>,
    /// The types of the cells of an unstructured grid.
    types: Option<Values>,
}

#[derive(Debug)]
struct Block {
    /// What all of its cells are; absent: their types tell.
    cell: Option<Cell>,
    ends: Vec<usize>,
    corners: Values,
}

impl Reader<'_> {
    /// Keeps the cells that a keyword begins.
    pub(super) fn keep_cells(&mut self, keyword: &[u8]) -> Result<(), ReadError> {
        let cell = match keyword.to_ascii_uppercase().as_slice() {
            b"CELLS" => None,
            b"POLYGONS" => Some(Cell::Polygon),
            b"TRIANGLE_STRIPS" => Some(Cell::Strip),
            _ => Some(Cell::Other),
        };
        let first = self.count("the number of cells")?;
        let second = self.count("the length of the list of cells")?;
        self.end_header();
        let (ends, corners) = match self.cursor.sees("OFFSETS") {
            true => self.offsets(first, second)?,
            false => self.counted_cells(first, second)?,
        };
        if let Some(cells) = &mut self.cells {
            cells.blocks.push(Block { cell, ends, corners });
        }
        Ok(())
    }

    /// Keeps the types of cells.
    pub(super) fn keep_cell_types(&mut self) -> Result<(), ReadError> {
        let count = self.count("the number of cell types")?;
        let types = self.numbers(Kind::I32, count, 1, "cell types")?;
        if let Some(cells) = &mut self.cells {
            cells.types = Some(types);
        }
        Ok(())
    }

    fn counted_cells(&mut self, count: usize, length: usize) -> Result<(Vec<usize>, Values), ReadError> {
        let list = self.numbers_here(Kind::I32, length, 1, "cells")?;
        let numbers = list.to_i32();
        let (mut ends, mut corners) = (Vec::new(), Vec::new());
        let mut rest = numbers.as_slice();
        for cell in 0..count {
            let parts = rest.split_first().and_then(|(points, after)| {
                let points = usize::try_from(*points).ok()?;
                after.split_at_checked(points)
            });
            let Some((points, after)) = parts else {
                return Err(self.error(format!("the list of cells ends within cell {cell}")));
            };
            corners.extend_from_slice(points);
            ends.push(corners.len());
            rest = after;
        }
        Ok((ends, Values::I32(corners)))
    }

    fn offsets(&mut self, offsets: usize, length: usize) -> Result<(Vec<usize>, Values), ReadError> {
        let mut found = Vec::new();
        for (keyword, count) in [("OFFSETS", offsets), ("CONNECTIVITY", length)] {
            let word = self.expect_word(keyword)?;
            if !word.eq_ignore_ascii_case(keyword.as_bytes()) {
                return Err(self.error_before(word, format!("expected {keyword}, found {}", shown(word))));
            }
            let Type::Numbers(kind) = self.number_type()? else {
                return Err(self.error("indices must be numbers"));
            };
            found.push(self.numbers(kind, count, 1, "cells")?);
            self.skip_metadata();
        }
        let corners = found.pop().unwrap_or_else(|| Values::empty(Kind::I32));
        let mut ends = Vec::with_capacity(offsets);
        let mut last = 0;
        // The first offset is 0, where no cell ends.
        for end in found.iter().flat_map(Values::to_i32).skip(1) {
            match usize::try_from(end) {
                Ok(end) if end >= last && end <= corners.len() => last = end,
                _ => return Err(self.error(format!("an offset of {end} among cells with {length} corners"))),
            }
            ends.push(last);
        }
        Ok((ends, corners))
    }
}

impl Cells {
    /// The polygons among the cells of a file with `count` points.
    pub fn polygons(self, count: usize) -> Result<Polygons, ReadError> {
        let types = self.types.map(|types| types.to_i32()).unwrap_or_default();
        let mut polygons = Polygons::default();
        let mut number = 0;
        for block in self.blocks {
            let corners = indices(&block.corners, count, "cell", &block.ends)?;
            let starts = std::iter::once(0).chain(block.ends.iter().copied());
            for (start, end) in starts.zip(&block.ends) {
                let cell = block.cell.unwrap_or_else(|| cell_of_type(types.get(number).copied()));
                number += usize::from(block.cell.is_none());
                polygons.push(cell, corners.get(start..*end).unwrap_or_default());
            }
        }
        Ok(polygons)
    }
}

fn cell_of_type(number: Option<i32>) -> Cell {
    match number {
        Some(5 | 7 | 9) => Cell::Polygon,
        Some(6) => Cell::Strip,
        Some(8) => Cell::Pixel,
        _ => Cell::Other,
    }
}
