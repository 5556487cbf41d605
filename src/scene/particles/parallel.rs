//! Long columns in parts, each on a thread of its own. Short ones stay on one.

use std::num::NonZero;
use std::thread;

/// Numbers below which a thread costs more than it saves.
const FEW: usize = 1 << 18;
/// More do not help: memory is the limit.
const MOST_THREADS: usize = 8;

/// Rows of a part, so that `rows` rows of `width` numbers are spread over the threads.
fn rows_of_a_part(rows: usize, width: usize) -> usize {
    let threads = thread::available_parallelism().map_or(1, NonZero::get).min(MOST_THREADS);
    let parts = if rows.saturating_mul(width) < FEW { 1 } else { threads };
    rows.div_ceil(parts).max(1)
}

/// A column of `rows` rows of `width` numbers, filled part by part; `fill` gets the first row of a
/// part and its numbers.
pub(super) fn filled<T: Copy + Default + Send>(
    rows: usize,
    width: usize,
    fill: impl Fn(usize, &mut [T]) + Sync,
) -> Vec<T> {
    let mut out = vec![T::default(); rows * width];
    let part = rows_of_a_part(rows, width);
    if width == 0 || part >= rows {
        fill(0, &mut out);
        return out;
    }
    thread::scope(|scope| {
        for (index, numbers) in out.chunks_mut(part * width).enumerate() {
            let fill = &fill;
            scope.spawn(move || fill(index * part, numbers));
        }
    });
    out
}

/// What `look` says of each part of some rows, in their order.
pub(super) fn looked_at<T: Sync, R: Send>(rows: &[T], width: usize, look: impl Fn(&[T]) -> R + Sync) -> Vec<R> {
    let part = rows_of_a_part(rows.len(), width);
    if part >= rows.len() {
        return vec![look(rows)];
    }
    thread::scope(|scope| {
        let look = &look;
        let parts: Vec<_> = rows.chunks(part).map(|rows| scope.spawn(move || look(rows))).collect();
        parts.into_iter().filter_map(|part| part.join().ok()).collect()
    })
}
