//! The bodies that a library was asked for, by their requests and by their handles.
//!
//! One thread looks up all of a batch while the others wait, so that little is touched for each: a table of handles by the hashes of
//! their requests, and lists in the order of the handles.

use hashbrown::HashTable;
use hashbrown::hash_table::Entry;

use crate::engine::body_request::{BodyHandle, BodyRequest};
use crate::engine::hashed::Hashed;
use crate::engine::outcome::BackendKind;
use crate::mechanics::compliance::BodyCompliance;

/// A request with its hash.
pub type RequestKey = Hashed<BodyRequest>;

/// A body with what has condensed it.
pub struct SolvedBody {
    pub compliance: BodyCompliance,
    pub backend: BackendKind,
    /// What its condensation in single precision leaves of a force, relative, at most.
    pub rounding: f64,
}

#[derive(Default)]
pub struct KnownBodies {
    handles: HashTable<BodyHandle>,
    /// By their handles; nothing where one is free.
    requests: Vec<Option<RequestKey>>,
    /// By their handles; nothing where one is free, or not solved yet.
    solved: Vec<Option<SolvedBody>>,
    free: Vec<BodyHandle>,
    unsolved: usize,
    /// What the solved bodies take.
    bytes: usize,
}

/// Bodies that are no longer known: they take their time to be dropped.
pub type Forgotten = Vec<Option<SolvedBody>>;

impl KnownBodies {
    /// What the solved bodies take, in bytes.
    pub fn bytes(&self) -> usize {
        self.bytes
    }

    /// Of a request that was made before.
    pub fn find(&self, request: &RequestKey) -> Option<BodyHandle> {
        let is_same = |handle: &BodyHandle| self.requests[handle.place()].as_ref() == Some(request);
        self.handles.find(request.own_hash(), is_same).copied()
    }

    /// Of a request; whether it is new, too.
    pub fn handle(&mut self, request: &RequestKey) -> (BodyHandle, bool) {
        let KnownBodies { handles, requests, solved, free, unsolved, .. } = self;
        let request_of = |handle: &BodyHandle| requests[handle.place()].as_ref();
        let is_same = |handle: &BodyHandle| request_of(handle) == Some(request);
        let hash_of = |handle: &BodyHandle| request_of(handle).map_or(0, Hashed::own_hash);
        let vacant = match handles.entry(request.own_hash(), is_same, hash_of) {
            Entry::Occupied(known) => return (*known.get(), false),
            Entry::Vacant(vacant) => vacant,
        };
        let handle = free.pop().unwrap_or(BodyHandle::of(requests.len()));
        vacant.insert(handle);
        *unsolved += 1;
        if handle.place() == requests.len() {
            requests.push(Some(request.clone()));
            solved.push(None);
        } else {
            requests[handle.place()] = Some(request.clone());
        }
        (handle, true)
    }

    /// The body of a handle, once it is solved.
    pub fn solved(&self, handle: BodyHandle) -> Option<&SolvedBody> {
        self.solved[handle.place()].as_ref()
    }

    /// Keeps the body of a handle, with what it takes in bytes.
    pub fn keep(&mut self, handle: BodyHandle, body: SolvedBody, bytes: usize) {
        let own = &mut self.solved[handle.place()];
        self.unsolved -= usize::from(own.is_none());
        self.bytes += bytes;
        *own = Some(body);
    }

    /// Forgets solved bodies, but for those of some requests. Those that are still to be solved stay.
    pub fn drop_all_but<'a>(&mut self, requests: impl Iterator<Item = &'a RequestKey>) -> Forgotten {
        let used: Vec<BodyHandle> = requests.filter_map(|request| self.find(request)).collect();
        if used.is_empty() && self.unsolved == 0 {
            // As in a sweep of ever new bodies.
            self.handles.clear();
            self.free.clear();
            self.requests.clear();
            self.bytes = 0;
            return self.solved.drain(..).collect();
        }
        let mut is_used = vec![false; self.requests.len()];
        used.iter().for_each(|handle| is_used[handle.place()] = true);
        let mut forgotten = Forgotten::default();
        for place in 0..self.requests.len() {
            if is_used[place] || self.solved[place].is_none() {
                continue;
            }
            let handle = BodyHandle::of(place);
            let hash = self.requests[place].as_ref().map_or(0, Hashed::own_hash);
            if let Ok(known) = self.handles.find_entry(hash, |own| *own == handle) {
                known.remove();
            }
            self.free.push(handle);
            self.requests[place] = None;
            forgotten.push(self.solved[place].take());
        }
        self.bytes = self.solved.iter().flatten().map(|body| body.compliance.bytes()).sum();
        forgotten
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::body_request::Fidelity;
    use crate::mechanics::body::Body;
    use crate::mechanics::compliance::Boundary;
    use crate::mechanics::material::Idealization;

    fn request(number: usize) -> RequestKey {
        let body = Body::concentric(2.0 + number as f64, 0.3, Idealization::PlaneStress);
        Hashed::new(BodyRequest { body, fidelity: Fidelity::Series })
    }

    fn body(number: usize) -> SolvedBody {
        let boundary = Boundary::Nothing;
        let compliance =
            BodyCompliance { even: number as f64, odd: 0.0, bed: 0.0, boundary, second: Vec::new() };
        SolvedBody { compliance, backend: BackendKind::Cpu, rounding: 0.0 }
    }

    fn solve(known: &mut KnownBodies, number: usize) {
        let (handle, is_new) = known.handle(&request(number));
        assert!(is_new && known.solved(handle).is_none(), "{number}");
        known.keep(handle, body(number), body(number).compliance.bytes());
        assert_eq!(known.handle(&request(number)), (handle, false));
    }

    fn is_there(known: &KnownBodies, number: usize) -> bool {
        let handle = known.find(&request(number));
        handle.is_some_and(|handle| {
            known.solved(handle).is_some_and(|body| body.compliance.even == number as f64)
        })
    }

    /// Each request has its own body, whatever was dropped before; those that are asked for and those that are not solved stay.
    #[test]
    fn bodies_are_those_of_their_requests() {
        let mut known = KnownBodies::default();
        (0..100).for_each(|number| solve(&mut known, number));
        assert!((0..100).all(|number| is_there(&known, number)) && !is_there(&known, 100));
        let of_one = known.bytes() / 100;
        let kept: Vec<RequestKey> = (0..100).step_by(3).map(request).collect();
        let (unsolved, _) = known.handle(&request(500));
        drop(known.drop_all_but(kept.iter().chain([&request(900)])));
        assert!((0..100).all(|number| is_there(&known, number) == number.is_multiple_of(3)));
        assert_eq!((known.bytes(), known.handles.len()), (34 * of_one, 35));
        // Handles that are free are given again.
        (200..290).for_each(|number| solve(&mut known, number));
        assert!((200..290).all(|number| is_there(&known, number)) && is_there(&known, 99));
        assert!(!is_there(&known, 1));
        // With one that is still to be solved nothing is asked for.
        drop(known.drop_all_but(std::iter::empty()));
        assert_eq!((known.find(&request(500)), known.bytes()), (Some(unsolved), 0));
        known.keep(unsolved, body(500), 7);
        assert_eq!(known.bytes(), 7);
        // And without.
        drop(known.drop_all_but(std::iter::empty()));
        assert_eq!((known.find(&request(500)), known.bytes()), (None, 0));
        (0..100).for_each(|number| solve(&mut known, number));
        assert!((0..100).all(|number| is_there(&known, number)));
    }
}
