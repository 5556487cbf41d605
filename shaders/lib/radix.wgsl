// What both kernels of the radix sort share: tiles of 1,024 items, digits of 5 bits, counters of each thread's own.

const RADIX_BITS = 5u;
const RADIX_DIGITS = 32u;
const RADIX_THREADS = 64u;
const RADIX_ITEMS = 16u;
const RADIX_TILE = 1024u;

/// counters[digit * RADIX_THREADS + thread]: no two threads share one, so no order of atomics can show.
var<workgroup> counters: array<u32, 2048>;

fn radix_digit(key: u32, place: u32) -> u32 {
    return (key >> (place * RADIX_BITS)) & (RADIX_DIGITS - 1u);
}

fn clear_counters(thread: u32) {
    for (var digit = 0u; digit < RADIX_DIGITS; digit++) {
        counters[digit * RADIX_THREADS + thread] = 0u;
    }
}
