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
// pivot the invocations first make the panel below it, a row each, then take its products from the tiles of the front, a tile each, and
// clear the tiles that enter; at last they put the values of these into their places, a row of a tile each.
//
// Rows of tiles lie in four planes, the first rows of all tiles before the second ones: what neighbours read at a time lies side by side.

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
    // Fours of one body's matrix.
    four_count: u32,
    // Numbers of one body in `works`.
    body_size: u32,
    rows_at: u32,
    places_at: u32,
    loads_at: u32,
    values_at: u32,
    states_at: u32,
    works_at: u32,
}

// [topology of the dispatch]
@group(0) @binding(0) var<storage, read> topologies: array<EliminateParameters>;
// A four is what is stored of the matrix: one row of a tile, with its zeros, since to write a component of a vector may write all of it, and
// several invocations must not. They follow each other tile by tile, row of tiles by row of tiles. Of each topology two lists, each where its parameters say:
// rows: [row of tiles][the last row that this one reaches as a pivot, and the end of the fours of the rows up to that one]
// places: [four]: row of tiles << 16 | columns of tiles from its tile to the diagonal << 4 | 4 where it stands for no unknown | row in the
// tile. Each row of a tile on the diagonal is there.
@group(0) @binding(1) var<storage, read> lists: array<u32>;
// Of each topology [row of the border][column of tiles of the ring]
@group(0) @binding(2) var<storage, read> loads: array<wide4>;
// [body][four]
@group(0) @binding(3) var<storage, read> values: array<wide4>;
// [body]
@group(0) @binding(4) var<storage, read> states: array<SystemState>;
// [body][1 for a sound body and 0 for any other, the greatest loss of a pivot, then packed entries, one way to push after the other]
@group(0) @binding(5) var<storage, read_write> works: array<wide>;
// [body][row of the tile][pair of rows in the front], where a workgroup's own memory has no room for it
@group(0) @binding(6) var<storage, read_write> fronts: array<wide4>;

// Pairs of rows in the front.
const TILES = FRONT * (FRONT + 1u) / 2u;

// [row of the tile][pair of rows in the front]
var<workgroup> front: array<wide4, select(1u, 4u * TILES, IS_FRONT_ON_CHIP)>;
// [row of the tile][row below the pivot]: the factor's column.
var<workgroup> panel: array<wide4, 4u * FRONT>;
// [row in the front][row of the tile]: its diagonal before anything was taken from it. By numbers: a vector is written as a whole.
var<workgroup> diagonals: array<wide, 4u * FRONT>;

// Of this body's topology.
var<private> parameters: EliminateParameters;
// Where this body's fours and its front in storage begin.
var<private> first_four: u32;
var<private> first_front: u32;

// Row of a tile of the front: `at` is row * TILES + tile.
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

// The tile of two places in the front, each of a row.
fn tile_of(a: u32, b: u32) -> u32 {
    let high = max(a, b);
    return high * (high + 1u) / 2u + min(a, b);
}

// Where a row of tiles is in the front, in the place of one that has left.
fn of_front(row: u32) -> u32 {
    return row % FRONT;
}

// The same for one that is less than a whole front beyond another one.
fn beyond(place: u32, rows: u32) -> u32 {
    let sum = place + rows;
    return select(sum, sum - FRONT, sum >= FRONT);
}

fn product(a: wide4, b: wide4) -> wide {
    return a.x * b.x + a.y * b.y + a.z * b.z + a.w * b.w;
}

struct Row {
    // That it reaches as a pivot.
    last: u32,
    // Of the fours of the rows up to that one.
    end: u32,
}

fn row_of_tiles(row: u32) -> Row {
    let at = parameters.rows_at + 2u * row;
    return Row(lists[at], lists[at + 1u]);
}

// One tile as it enters the front: zero but for the loads of the ring's unknowns.
fn clear(row: u32, column: u32) {
    let at = tile_of(of_front(row), of_front(column));
    if row >= parameters.row_count && column < parameters.row_count {
        let ring = parameters.row_count - parameters.ring_row;
        let own = parameters.loads_at + 4u * (row - parameters.row_count) * ring + column - parameters.ring_row;
        keep(at, loads[own]);
        keep(at + TILES, loads[own + ring]);
        keep(at + 2u * TILES, loads[own + 2u * ring]);
        keep(at + 3u * TILES, loads[own + 3u * ring]);
    } else {
        keep(at, wide4());
        keep(at + TILES, wide4());
        keep(at + 2u * TILES, wide4());
        keep(at + 3u * TILES, wide4());
    }
}

// Rows up to `last` enter the front that begins with the column `first`.
fn clear_rows(begin: u32, last: u32, first: u32, invocation: u32) {
    for (var row = begin; row <= last; row++) {
        for (var column = first + invocation; column <= row; column += INVOCATIONS) {
            clear(row, column);
        }
    }
}

struct Four {
    place: u32,
    values: wide4,
}

fn four_of_body(four: u32) -> Four {
    return Four(lists[parameters.places_at + four], values[first_four + four]);
}

// Puts a four into its tile.
fn enter(four: Four) {
    let row = four.place >> 16u;
    let column = row - ((four.place >> 4u) & 0xfffu);
    let i = four.place & 3u;
    let place = of_front(row);
    let is_padding = (four.place & 4u) != 0u;
    let unit = select(wide4(), wide4(wide(1.0)), vec4<u32>(i) == vec4<u32>(0u, 1u, 2u, 3u));
    let own = select(four.values, unit, is_padding);
    keep(i * TILES + tile_of(place, of_front(column)), own);
    if row == column {
        diagonals[4u * place + i] = own[i];
    }
}

struct Factor {
    // With the inverse of its diagonal in the place of that.
    lower: array<wide4, 4>,
    // What was left of the diagonal.
    pivots: wide4,
}

// Of a pivot's tile, which is on the diagonal.
fn factor(at: u32) -> Factor {
    let a0 = of_tile(at);
    let a1 = of_tile(at + TILES);
    let a2 = of_tile(at + 2u * TILES);
    let a3 = of_tile(at + 3u * TILES);
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

// Takes from a row of a tile its products with those of another one of the panel.
fn subtract(at: u32, a: wide4, b0: wide4, b1: wide4, b2: wide4, b3: wide4) {
    keep(at, of_tile(at) - wide4(product(a, b0), product(a, b1), product(a, b2), product(a, b3)));
}

// One number of the corner of the border, whose row is not in a tile before that of its column.
fn corner(row: u32, column: u32) -> wide {
    let tile = tile_of(of_front(parameters.row_count + row / 4u), of_front(parameters.row_count + column / 4u));
    return -of_tile(row % 4u * TILES + tile)[column % 4u];
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
    first_four = parameters.values_at + body * parameters.four_count;
    first_front = group.x * 4u * TILES;
    // The greatest of what a pivot's diagonal was, over what was left of it.
    var loss = wide(1.0);
    var is_sound = states[parameters.states_at + body].outcome == RUNNING;
    // Of the pivot, and its place in the front.
    var own = row_of_tiles(0u);
    var place = 0u;
    clear_rows(0u, own.last, 0u, invocation);
    wait();
    for (var four = invocation; four < own.end; four += INVOCATIONS) {
        enter(four_of_body(four));
    }
    wait();
    // From memory that nothing writes, so that compilers see all invocations make as many rounds.
    let row_count = topologies[topology].row_count;
    // What the lists say of the next pivot is loaded a round before it is asked for, and the first four that enters before the panel is
    // made: the device has them when it comes to them. Beyond the last pivot comes the same again, and nothing enters.
    var next = row_of_tiles(min(1u, row_count - 1u));
    for (var pivot = 0u; pivot < row_count; pivot++) {
        var four = own.end + invocation;
        var entering = Four();
        if four < next.end {
            entering = four_of_body(four);
        }
        let following = row_of_tiles(min(pivot + 2u, row_count - 1u));
        let below = own.last - pivot;
        // Of the first row below.
        let first = beyond(place, 1u);
        for (var row = invocation; row < below; row += INVOCATIONS) {
            let factor = factor(tile_of(place, place));
            if row == 0u {
                for (var i = 0u; i < 4u; i++) {
                    is_sound &= factor.pivots[i] > wide(0.0) && is_finite(factor.pivots[i]);
                    loss = max(loss, diagonals[4u * place + i] / factor.pivots[i]);
                }
            }
            let at = tile_of(beyond(first, row), place);
            panel[row] = divided(of_tile(at), factor.lower);
            panel[FRONT + row] = divided(of_tile(at + TILES), factor.lower);
            panel[2u * FRONT + row] = divided(of_tile(at + 2u * TILES), factor.lower);
            panel[3u * FRONT + row] = divided(of_tile(at + 3u * TILES), factor.lower);
        }
        workgroupBarrier();
        for (var entry = invocation; entry < below * (below + 1u) / 2u; entry += INVOCATIONS) {
            let pair = packed_place(entry);
            let at = tile_of(beyond(first, pair.x), beyond(first, pair.y));
            let b0 = panel[pair.y];
            let b1 = panel[FRONT + pair.y];
            let b2 = panel[2u * FRONT + pair.y];
            let b3 = panel[3u * FRONT + pair.y];
            subtract(at, panel[pair.x], b0, b1, b2, b3);
            subtract(at + TILES, panel[FRONT + pair.x], b0, b1, b2, b3);
            subtract(at + 2u * TILES, panel[2u * FRONT + pair.x], b0, b1, b2, b3);
            subtract(at + 3u * TILES, panel[3u * FRONT + pair.x], b0, b1, b2, b3);
        }
        clear_rows(own.last + 1u, next.last, pivot + 1u, invocation);
        wait();
        if four < next.end {
            enter(entering);
        }
        for (four += INVOCATIONS; four < next.end; four += INVOCATIONS) {
            enter(four_of_body(four));
        }
        wait();
        own = next;
        next = following;
        place = first;
    }
    let modes = parameters.mode_count;
    let entries = modes * (modes + 1u) / 2u;
    let ways = 4u * parameters.border_count / modes;
    let works_of_body = parameters.works_at + body * parameters.body_size;
    for (var way = 0u; way < ways; way++) {
        for (var entry = invocation; entry < entries; entry += INVOCATIONS) {
            let pair = packed_place(entry);
            works[works_of_body + WORKS_HEADER + way * entries + entry] = work(way, pair.x, pair.y);
        }
    }
    if invocation == 0u {
        works[works_of_body] = select(wide(0.0), wide(1.0), is_sound);
        works[works_of_body + 1u] = loss;
    }
}
