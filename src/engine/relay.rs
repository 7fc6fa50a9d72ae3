//! Work on pieces by two threads: one makes them while the other takes those before.

use std::sync::mpsc::sync_channel;
use std::thread;

use crate::engine::threads::{joined, spawned};
use crate::error::Error;

/// Pieces that are made and not taken, at most.
const AHEAD: usize = 4;

/// Why no more pieces are made.
#[derive(Debug)]
pub enum Ended {
    /// Nobody takes them any more.
    NotTaken,
    Failed(Error),
}

/// Takes, in their order, the pieces that `make` hands over on a thread of its own, until one of the two fails. What `take` says against a
/// piece comes before what `make` says.
pub fn relay<T: Send>(
    make: impl FnOnce(&mut dyn FnMut(T) -> Result<(), Ended>) -> Result<(), Ended> + Send,
    mut take: impl FnMut(T) -> Result<(), Error>,
) -> Result<(), Error> {
    thread::scope(|scope| {
        let (sender, receiver) = sync_channel(AHEAD);
        let maker =
            spawned(scope, move || make(&mut |piece| sender.send(piece).map_err(|_| Ended::NotTaken)))?;
        let taken = receiver.iter().try_for_each(&mut take);
        // A maker that waits for room is told that there is no more need of it.
        drop(receiver);
        match (taken, joined(maker)) {
            (Err(error), _) | (Ok(()), Err(Ended::Failed(error))) => Err(error),
            (Ok(()), Ok(()) | Err(Ended::NotTaken)) => Ok(()),
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn failed(problem: &str) -> Error {
        Error::Asked { problem: problem.into() }
    }

    /// Hands over so many pieces, and fails behind them.
    fn made(
        count: usize,
        failure: Option<&'static str>,
        taken_up_to: usize,
    ) -> (Vec<usize>, Result<(), String>) {
        let mut taken = Vec::new();
        let make = |give: &mut dyn FnMut(usize) -> Result<(), Ended>| {
            (0..count).try_for_each(give)?;
            failure.map_or(Ok(()), |failure| Err(Ended::Failed(failed(failure))))
        };
        let take = |piece| {
            taken.push(piece);
            if piece + 1 == taken_up_to { Err(failed("not taken")) } else { Ok(()) }
        };
        let ended = relay(make, take);
        (taken, ended.map_err(|error| error.to_string()))
    }

    #[test]
    fn pieces_come_in_order_until_one_of_the_two_fails() {
        let first = |count: usize| (0..count).collect::<Vec<_>>();
        assert_eq!(made(1000, None, usize::MAX), (first(1000), Ok(())));
        assert_eq!(made(20, Some("not made"), usize::MAX), (first(20), Err("not made".into())));
        // A maker of endless pieces ends, too.
        assert_eq!(made(usize::MAX, None, 7), (first(7), Err("not taken".into())));
        assert_eq!(made(3, Some("not made"), 3), (first(3), Err("not taken".into())));
    }
}
