// Twin: src/mechanics/solve/band.rs (factorise), src/mechanics/compliance/lane_condensation.rs (gram): the same elimination, which
// they take row by row and this takes column by column.
//
// From the stiffness K of a body and the loads F of its ring's modes to their works F^T K^-1 F, by elimination: K is bordered by the
// loads, and what elimination leaves in the corner of the border is -F^T K^-1 F.
//
//     | K    F |        unknowns in the order of elimination, from the far boundary to the ring, padded to whole tiles;
//     | F^T  0 |        of the loads those of each way to push, mode after mode
//
// One workgroup eliminates one body, in tiles of 4 x 4 unknowns. It holds the front: the tiles of the rows that the next
// column reaches. A row of tiles enters the front where its band begins, those of the loads at the ring, and leaves it as the pivot. Of each
// pivot the invocations first make the panel below it, a row each, then take its products from the tiles of the front, a tile each.

// Of the bodies of one topology in a dispatch. `_at`: where in a buffer of all topologies that which is of this one begins, in its elements.
struct EliminateParameters {
    // Workgroups of the dispatch before those of this topology.
    first_body: u32,
    // Rows of tiles of K, and the first one of the ring.
    row_count: u32,
    ring_row: u32,
    // Rows of tiles of the loads.
    border_count: u32,
    mode_count: u32,
    // Values of one body's matrix.
    value_count: u32,
    // Numbers of one body in `works`.
    body_size: u32,
    rows_at: u32,
    tile_starts_at: u32,
    places_at: u32,
    loads_at: u32,
    values_at: u32,
    states_at: u32,
    works_at: u32,
}

// [topology of the dispatch]
@group(0) @binding(0) var<storage, read> topologies: array<EliminateParameters>;
// Of each topology three lists, each where its parameters say:
// rows: [row of tiles][column of its first tile, the number of that tile, the last row that this one reaches as a pivot, and a bit for each
// of its four rows that stands for no unknown]
// tile_starts: [tile]: its first value; the end of the last one closes the list.
// places: [value]: its place in its tile, 4 row + column.
@group(0) @binding(1) var<storage, read> lists: array<u32>;
// Of each topology [row of the border][column of tiles of the ring]
@group(0) @binding(2) var<storage, read> loads: array<wide4>;
// [body][value]
@group(0) @binding(3) var<storage, read> values: array<wide>;
// [body]
@group(0) @binding(4) var<storage, read> states: array<SystemState>;
// [body][1 for a sound body and 0 for any other, the greatest loss of a pivot, then packed entries, one way to push after the other]
@group(0) @binding(5) var<storage, read_write> works: array<wide>;
// [body][pair of rows in the front][row of the tile], where a workgroup's own memory has no room for it
@group(0) @binding(6) var<storage, read_write> fronts: array<wide4>;

const FRONT_SIZE = 2u * FRONT * (FRONT + 1u);

// [pair of rows in the front][row of the tile]
var<workgroup> front: array<wide4, select(1u, FRONT_SIZE, IS_FRONT_ON_CHIP)>;
// [row below the pivot][row of the tile]: the factor's column.
var<workgroup> panel: array<wide4, 4u * FRONT>;
// [row in the front]: its diagonal before anything was taken from it.
var<workgroup> diagonals: array<wide4, FRONT>;

// Of this body's topology.
var<private> parameters: EliminateParameters;
// Where this body's values and its front in storage begin.
var<private> first_value: u32;
var<private> first_front: u32;

fn of_tile(at: u32) -> wide4 {
    if IS_FRONT_ON_CHIP {
        return front[at];
    }
    return fronts[first_front + at];
}

fn keep(at: u32, row: wide4) {
    if IS_FRONT_ON_CHIP {
        front[at] = row;
    } else {
        fronts[first_front + at] = row;
    }
}

// What each invocation has written is there for all others.
fn wait() {
    if !IS_FRONT_ON_CHIP {
        storageBarrier();
    }
    workgroupBarrier();
}

// Where the tile of two rows of tiles is in the front. Rows take the places of those that have left.
fn of_front(row: u32, column: u32) -> u32 {
    let a = row % FRONT;
    let b = column % FRONT;
    let high = max(a, b);
    return 4u * (high * (high + 1u) / 2u + min(a, b));
}

fn product(a: wide4, b: wide4) -> wide {
    return a.x * b.x + a.y * b.y + a.z * b.z + a.w * b.w;
}

struct Row {
    // Of its first tile.
    column: u32,
    tile: u32,
    // That it reaches as a pivot.
    last: u32,
    // A bit for each of its four rows that stands for no unknown.
    padding: u32,
}

fn row_of_tiles(row: u32) -> Row {
    let at = parameters.rows_at + 4u * row;
    return Row(lists[at], lists[at + 1u], lists[at + 2u], lists[at + 3u]);
}

fn tile_start(tile: u32) -> u32 {
    return lists[parameters.tile_starts_at + tile];
}

// One tile as it enters the front.
fn enter(row: u32, column: u32) {
    var tile = array<wide4, 4>();
    let of_row = row_of_tiles(min(row, parameters.row_count - 1u));
    if row >= parameters.row_count {
        if column < parameters.row_count {
            let ring = parameters.row_count - parameters.ring_row;
            let own = 4u * (row - parameters.row_count) * ring + column - parameters.ring_row;
            for (var i = 0u; i < 4u; i++) {
                tile[i] = loads[parameters.loads_at + own + i * ring];
            }
        }
    } else if column >= of_row.column {
        let number = of_row.tile + column - of_row.column;
        let end = tile_start(number + 1u);
        for (var value = tile_start(number); value < end; value++) {
            let place = lists[parameters.places_at + value];
            tile[place / 4u][place % 4u] = values[first_value + value];
        }
    }
    if row == column {
        for (var i = 0u; i < 4u; i++) {
            if row < parameters.row_count && (of_row.padding & (1u << i)) != 0u {
                tile[i][i] = wide(1.0);
            }
        }
        diagonals[row % FRONT] = wide4(tile[0].x, tile[1].y, tile[2].z, tile[3].w);
    }
    let at = of_front(row, column);
    for (var i = 0u; i < 4u; i++) {
        keep(at + i, tile[i]);
    }
}

// Rows up to `last` enter the front that begins with the column `first`.
fn enter_rows(begin: u32, last: u32, first: u32, invocation: u32) {
    for (var row = begin; row <= last; row++) {
        for (var column = first + invocation; column <= row; column += INVOCATIONS) {
            enter(row, column);
        }
    }
}

struct Factor {
    // With the inverse of its diagonal in the place of that.
    lower: array<wide4, 4>,
    // What was left of the diagonal.
    pivots: wide4,
}

// Of a pivot's tile.
fn factor(at: u32) -> Factor {
    let a0 = of_tile(at);
    let a1 = of_tile(at + 1u);
    let a2 = of_tile(at + 2u);
    let a3 = of_tile(at + 3u);
    let l00 = wide(1.0) / sqrt(a0.x);
    let l10 = a1.x * l00;
    let l20 = a2.x * l00;
    let l30 = a3.x * l00;
    let p1 = a1.y - l10 * l10;
    let l11 = wide(1.0) / sqrt(p1);
    let l21 = (a2.y - l20 * l10) * l11;
    let l31 = (a3.y - l30 * l10) * l11;
    let p2 = a2.z - l20 * l20 - l21 * l21;
    let l22 = wide(1.0) / sqrt(p2);
    let l32 = (a3.z - l30 * l20 - l31 * l21) * l22;
    let p3 = a3.w - l30 * l30 - l31 * l31 - l32 * l32;
    let l33 = wide(1.0) / sqrt(p3);
    let none = wide(0.0);
    let lower = array<wide4, 4>(
        wide4(l00, none, none, none),
        wide4(l10, l11, none, none),
        wide4(l20, l21, l22, none),
        wide4(l30, l31, l32, l33),
    );
    return Factor(lower, wide4(a0.x, p1, p2, p3));
}

// A row of the panel: that of the front, by the transposed factor of the pivot.
fn divided(row: wide4, lower: array<wide4, 4>) -> wide4 {
    let x = row.x * lower[0].x;
    let y = (row.y - x * lower[1].x) * lower[1].y;
    let z = (row.z - x * lower[2].x - y * lower[2].y) * lower[2].z;
    let w = (row.w - x * lower[3].x - y * lower[3].y - z * lower[3].z) * lower[3].w;
    return wide4(x, y, z, w);
}

// One number of the corner of the border, whose row is not in a tile before that of its column.
fn corner(row: u32, column: u32) -> wide {
    let at = of_front(parameters.row_count + row / 4u, parameters.row_count + column / 4u);
    return -of_tile(at + row % 4u)[column % 4u];
}

// The work of one mode on another, m >= n, pushed one way; the symmetric part where it is not the normal.
fn work(way: u32, m: u32, n: u32) -> wide {
    if way == 0u {
        return corner(m, n);
    }
    let first = way * parameters.mode_count;
    return wide(0.5) * (corner(first + m, n) + corner(first + n, m));
}

@compute @workgroup_size(INVOCATIONS)
fn eliminate(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(local_invocation_index) invocation: u32,
) {
    let topology = topology_of(group.x);
    parameters = topologies[topology];
    // Of its topology in the dispatch.
    let body = group.x - parameters.first_body;
    first_value = parameters.values_at + body * parameters.value_count;
    first_front = group.x * FRONT_SIZE;
    // The greatest of what a pivot's diagonal was, over what was left of it.
    var loss = wide(1.0);
    var is_sound = states[parameters.states_at + body].outcome == RUNNING;
    var last = row_of_tiles(0u).last;
    enter_rows(0u, last, 0u, invocation);
    wait();
    // From memory that nothing writes, so that compilers see all invocations make as many rounds.
    let row_count = topologies[topology].row_count;
    for (var pivot = 0u; pivot < row_count; pivot++) {
        let below = last - pivot;
        for (var row = invocation; row < below; row += INVOCATIONS) {
            let factor = factor(of_front(pivot, pivot));
            if row == 0u {
                for (var i = 0u; i < 4u; i++) {
                    is_sound &= factor.pivots[i] > wide(0.0) && is_finite(factor.pivots[i]);
                    loss = max(loss, diagonals[pivot % FRONT][i] / factor.pivots[i]);
                }
            }
            let at = of_front(pivot + 1u + row, pivot);
            for (var i = 0u; i < 4u; i++) {
                panel[4u * row + i] = divided(of_tile(at + i), factor.lower);
            }
        }
        workgroupBarrier();
        for (var entry = invocation; entry < below * (below + 1u) / 2u; entry += INVOCATIONS) {
            let place = packed_place(entry);
            let at = of_front(pivot + 1u + place.x, pivot + 1u + place.y);
            let b0 = panel[4u * place.y];
            let b1 = panel[4u * place.y + 1u];
            let b2 = panel[4u * place.y + 2u];
            let b3 = panel[4u * place.y + 3u];
            for (var i = 0u; i < 4u; i++) {
                let a = panel[4u * place.x + i];
                let products = wide4(product(a, b0), product(a, b1), product(a, b2), product(a, b3));
                keep(at + i, of_tile(at + i) - products);
            }
        }
        if pivot + 1u < row_count {
            let next = row_of_tiles(pivot + 1u).last;
            enter_rows(last + 1u, next, pivot + 1u, invocation);
            last = next;
        }
        wait();
    }
    let modes = parameters.mode_count;
    let entries = modes * (modes + 1u) / 2u;
    let ways = 4u * parameters.border_count / modes;
    let own = parameters.works_at + body * parameters.body_size;
    for (var way = 0u; way < ways; way++) {
        for (var entry = invocation; entry < entries; entry += INVOCATIONS) {
            let place = packed_place(entry);
            works[own + WORKS_HEADER + way * entries + entry] = work(way, place.x, place.y);
        }
    }
    if invocation == 0u {
        works[own] = select(wide(0.0), wide(1.0), is_sound);
        works[own + 1u] = loss;
    }
}
