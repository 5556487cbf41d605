// Groups of particles as trees (Jaiganesh and Burtscher 2018; Playne and Hawick 2018): each points at one of a lower
// number, and the lowest at itself. Whatever the order of the threads, a group's root is its lowest number in the end.

var<storage, read_write> group: array<atomic<u32>>;

/// The root of a particle's tree; the way to it is shortened.
fn root_of(i: u32) -> u32 {
    var at = i;
    loop {
        let up = atomicLoad(&group[at]);
        if up == at {
            return at;
        }
        let above = atomicLoad(&group[up]);
        if above != up {
            atomicMin(&group[at], above);
        }
        at = up;
    }
    return at;
}

/// Makes two particles' groups one.
fn join_groups(i: u32, j: u32) {
    var a = root_of(i);
    var b = root_of(j);
    while a != b {
        let high = max(a, b);
        let low = min(a, b);
        let before = atomicMin(&group[high], low);
        if before == high {
            return;
        }
        // Another thread was quicker: what it hung `high` on and `low` are still to be joined.
        a = root_of(before);
        b = root_of(low);
    }
}
