//! Work on pieces by two threads: one makes them while the other takes those before.

use std::panic::resume_unwind;
use std::sync::mpsc::sync_channel;
use std::thread;

/// Pieces that are made and not taken, at most.
const AHEAD: usize = 4;

/// Why no more pieces are made.
#[derive(Debug, PartialEq, Eq)]
pub enum Ended<E> {
    /// Nobody takes them any more.
    NotTaken,
    Failed(E),
}

/// Takes, in their order, the pieces that `make` hands over on a thread of its own, until one of the two fails. What `take` says against a
/// piece comes before what `make` says.
pub fn relay<T: Send, E: Send>(
    make: impl FnOnce(&mut dyn FnMut(T) -> Result<(), Ended<E>>) -> Result<(), Ended<E>> + Send,
    mut take: impl FnMut(T) -> Result<(), E>,
) -> Result<(), E> {
    thread::scope(|scope| {
        let (sender, receiver) = sync_channel(AHEAD);
        let maker = scope.spawn(move || make(&mut |piece| sender.send(piece).map_err(|_| Ended::NotTaken)));
        let taken = receiver.iter().try_for_each(&mut take);
        // A maker that waits for room is told that there is no more need of it.
        drop(receiver);
        let made = maker.join().unwrap_or_else(|panic| resume_unwind(panic));
        match (taken, made) {
            (Err(error), _) | (Ok(()), Err(Ended::Failed(error))) => Err(error),
            (Ok(()), Ok(()) | Err(Ended::NotTaken)) => Ok(()),
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Hands over so many pieces, and fails behind them.
    fn made(
        count: usize,
        failure: Option<&'static str>,
        taken_up_to: usize,
    ) -> (Vec<usize>, Result<(), &'static str>) {
        let mut taken = Vec::new();
        let make = |give: &mut dyn FnMut(usize) -> Result<(), Ended<&'static str>>| {
            (0..count).try_for_each(give)?;
            failure.map_or(Ok(()), |failure| Err(Ended::Failed(failure)))
        };
        let take = |piece| {
            taken.push(piece);
            if piece + 1 == taken_up_to { Err("not taken") } else { Ok(()) }
        };
        let ended = relay(make, take);
        (taken, ended)
    }

    #[test]
    fn pieces_come_in_order_until_one_of_the_two_fails() {
        let first = |count: usize| (0..count).collect::<Vec<_>>();
        assert_eq!(made(1000, None, usize::MAX), (first(1000), Ok(())));
        assert_eq!(made(20, Some("not made"), usize::MAX), (first(20), Err("not made")));
        // A maker of endless pieces ends, too.
        assert_eq!(made(usize::MAX, None, 7), (first(7), Err("not taken")));
        assert_eq!(made(3, Some("not made"), 3), (first(3), Err("not taken")));
    }
}
