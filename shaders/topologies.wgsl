// Joined in front of the kernels whose dispatches have bodies of many topologies: the bodies of one follow each other, and
// `topologies` says which is the first.

// The topology of a body of the dispatch: the last one that begins with it or before.
fn topology_of(body: u32) -> u32 {
    var low = 0u;
    var high = arrayLength(&topologies);
    while high - low > 1u {
        let middle = (low + high) / 2u;
        if topologies[middle].first_body <= body {
            low = middle;
        } else {
            high = middle;
        }
    }
    return low;
}
